#include "server/store/crash_recovery.hpp"

#include "server/store/directory.hpp"
#include "server/store/log_file.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kManifest = "MANIFEST-";

Result<std::string> contents_of(const fs::path& file) {
    std::error_code problem;
    const auto size = fs::file_size(file, problem);
    if (problem) return failure("cannot read {} of the store: {}", file.native(), problem.message());
    std::string bytes(size, '\0');
    std::ifstream in(file, std::ios::binary);
    if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) {
        return failure("cannot read {} of the store; check the disk", file.native());
    }
    return bytes;
}

Result<LogFileCheck> checked(const fs::path& file) {
    const auto bytes = contents_of(file);
    if (!bytes) return bytes.error();
    auto check = check_log_file(*bytes);
    if (check.damage) {
        return failure("{} of the store is damaged at byte {}; {}", file.native(), *check.damage, kRecover);
    }
    return check;
}

using Logs = std::map<std::uint64_t, fs::path>;

/// Parses what follows "MANIFEST-" or precedes ".log".
std::optional<std::uint64_t> number_in(std::string_view digits) {
    std::uint64_t number = 0;
    const auto [end, unread] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (unread != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
    return number;
}

/// Returns the logs by ascending number, so the last one is the newest. The others were synced completely, and RocksDB
/// recorded their sizes in its manifest.
Logs write_ahead_logs(const fs::path& directory) {
    Logs logs;
    for (const auto& file : regular_files(directory, ".log")) {
        if (const auto number = number_in(file.stem().native())) logs.emplace(*number, file);
    }
    return logs;
}

Result<> cut_off(const fs::path& file, std::size_t bytes) {
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
    const bool done =
        descriptor >= 0 && ::ftruncate(descriptor, static_cast<off_t>(bytes)) == 0 && ::fsync(descriptor) == 0;
    const std::string problem = std::system_category().message(errno);
    if (descriptor >= 0) ::close(descriptor);
    if (done) return {};
    return failure("cannot cut the unfinished write off {} of the store: {}", file.native(), problem);
}

} // namespace

Result<> check_newest_log(const fs::path& directory) {
    const auto logs = write_ahead_logs(directory);
    std::error_code problem;
    if (logs.empty() || fs::file_size(logs.rbegin()->second, problem) > 0 || problem) return {};
    std::ifstream in(directory / "CURRENT");
    std::string manifest;
    if (!(in >> manifest) || !manifest.starts_with(kManifest)) return {}; // a new store
    const auto number = number_in(std::string_view(manifest).substr(kManifest.size()));
    if (!number || logs.rbegin()->first + 1 >= *number) return {};
    return failure("the newest write-ahead log of the store {} is missing: {} is older than {}; {}", directory.native(),
                   logs.rbegin()->second.filename().native(), manifest, kRecover);
}

Result<> check_manifest(const fs::path& directory) {
    std::error_code problem;
    const fs::path current = directory / "CURRENT";
    if (!fs::exists(current, problem)) return {}; // a new store
    const auto name = contents_of(current);
    if (!name) return name.error();
    if (!name->starts_with("MANIFEST-") || name->find_first_not_of("0123456789", 9) != name->size() - 1 ||
        !name->ends_with('\n')) {
        return failure("{} of the store is damaged: it does not name a manifest; {}", current.native(), kRecover);
    }
    const fs::path manifest = directory / name->substr(0, name->size() - 1);
    if (!fs::exists(manifest, problem)) {
        return failure("{} of the store is missing; {}", manifest.native(), kRecover);
    }
    const auto check = checked(manifest);
    if (!check) return check.error();
    if (check->whole_bytes == 0) {
        return failure("{} of the store has lost its contents; {}", manifest.native(), kRecover);
    }
    return {};
}

Result<std::optional<UnfinishedWrite>> find_unfinished_write(const LockedDirectory& directory) {
    if (auto manifest = check_manifest(directory.path()); !manifest) return manifest.error();
    if (auto newest = check_newest_log(directory.path()); !newest) return newest.error();
    const auto logs = write_ahead_logs(directory.path());
    std::optional<UnfinishedWrite> unfinished;
    for (const auto& [number, log] : logs) {
        if (unfinished) {
            return failure("{} of the store is damaged at byte {}; {}", unfinished->file.native(),
                           unfinished->whole_bytes, kRecover);
        }
        const auto check = checked(log);
        if (!check) return check.error();
        std::error_code problem;
        const auto size = fs::file_size(log, problem);
        if (problem) return failure("cannot read {} of the store: {}", log.native(), problem.message());
        if (check->whole_bytes < size) unfinished = {log, check->whole_bytes, size - check->whole_bytes};
    }
    return unfinished;
}

Result<std::uint64_t> cut_off_unfinished_write(const LockedDirectory& directory) {
    const auto unfinished = find_unfinished_write(directory);
    if (!unfinished) return unfinished.error();
    if (!*unfinished) return std::uint64_t{0};
    if (auto cut = cut_off((*unfinished)->file, (*unfinished)->whole_bytes); !cut) return cut.error();
    return (*unfinished)->bytes;
}

} // namespace scanloom::store
