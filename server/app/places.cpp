#include "server/app/places.hpp"

#include "server/store/open_store.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <system_error>

namespace scanloom::app {
namespace {

namespace fs = std::filesystem;

/// Returns the absolute path, with the symbolic links of its existing part resolved, and without a slash at the end.
fs::path place_of(const fs::path& directory) {
    std::error_code problem;
    auto place = fs::weakly_canonical(fs::absolute(directory), problem);
    if (problem) place = fs::absolute(directory).lexically_normal();
    return place.has_filename() ? place : place.parent_path();
}

bool is_same(const fs::path& one, const fs::path& other) {
    std::error_code none;
    return one == other || fs::equivalent(one, other, none); // equivalent under two paths if mounted twice
}

bool is_at_or_in(const fs::path& inner, const fs::path& outer) {
    for (auto place = inner; !is_same(place, outer); place = place.parent_path()) {
        if (!place.has_relative_path()) return false;
    }
    return true;
}

struct Place {
    std::string_view flag;
    const fs::path& directory;
};

Result<> check_apart(const Place& one, const Place& other) {
    const auto first = place_of(one.directory);
    const auto second = place_of(other.directory);
    const bool is_inside = is_at_or_in(first, second);
    if (!is_inside && !is_at_or_in(second, first)) return {};
    const auto& [inner, outer] = is_inside ? std::pair(one, other) : std::pair(other, one);
    return Error{Errc::kInvalidField,
                 fmt::format("{} {} is {} {} {}; give a separate directory", inner.flag, inner.directory.native(),
                             is_same(first, second) ? "the same directory as" : "inside", outer.flag,
                             outer.directory.native())};
}

/// Refuses to copy a store to itself.
Result<> check_copy(const ServerOptions& options) {
    const bool are_directories = !store::is_in_database(options.store) && !store::is_in_database(options.copied);
    if (are_directories) return check_apart({"--to", options.copied}, {"--copy", options.store});
    if (options.store != options.copied) return {};
    return Error{Errc::kInvalidField, "--to is the database of --copy; name another one"};
}

/// Refuses what only directories have.
Result<> check_database(const ServerOptions& options) {
    const auto refused = [](std::string_view flag, std::string_view advice) {
        return Error{Errc::kInvalidField, fmt::format("{} is for a store in a directory; {}", flag, advice)};
    };
    switch (options.task) {
    case Task::kRepair: return refused("--repair", "restore the database from a backup");
    case Task::kRestore: return refused("--restore", "restore the database from its own backup");
    case Task::kCheck:
    case Task::kCheckMaps:
    case Task::kCopy:
    case Task::kServe: break;
    }
    if (!options.backups.empty()) return refused("--backups", "make backups of the database");
    return {};
}

} // namespace

Result<> check_places(const ServerOptions& options) {
    if (options.task == Task::kCopy) return check_copy(options);
    if (store::is_in_database(options.store)) return check_database(options);
    if (options.store_bytes_max) {
        return Error{Errc::kInvalidField,
                     "--store-size-max is for a store in a database; a directory has --disk-reserve"};
    }
    if (!options.node.empty()) return Error{Errc::kInvalidField, "--node is for a store in a database"};
    const Place store{"--store", options.store};
    switch (options.task) {
    case Task::kCheck:
    case Task::kCheckMaps: return {};
    case Task::kRepair: return check_apart({"--repair", options.repaired}, store);
    case Task::kCopy:
    case Task::kServe:
    case Task::kRestore: break;
    }
    if (options.backups.empty()) return {};
    return check_apart({"--backups", options.backups}, store);
}

} // namespace scanloom::app
