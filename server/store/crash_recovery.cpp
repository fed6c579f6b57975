#include "server/store/crash_recovery.hpp"

#include "common/text/parse_number.hpp"
#include "server/store/directory.hpp"
#include "server/store/log_file.hpp"
#include "server/store/store_error.hpp"

#include <rocksdb/env.h>

#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <system_error>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kManifest = "MANIFEST-";

Result<std::string> contents_of(const fs::path& file) {
    std::string bytes;
    const auto status = rocksdb::ReadFileToString(rocksdb::Env::Default(), file.native(), &bytes);
    if (status.ok()) return bytes;
    return failure("cannot read {} of the store: {}; check its disk", file.native(), status.ToString());
}

Error damaged_at(const fs::path& file, std::uint64_t byte) {
    return failure("{} of the store is damaged at byte {}; {}", file.native(), byte, kRecover);
}

/// Finds the end of the complete writes of a file, and the size of an unfinished one behind them, 0 if there is none.
Result<UnfinishedWrite> checked(const fs::path& file) {
    const auto bytes = contents_of(file);
    if (!bytes) return bytes.error();
    const auto check = check_log_file(*bytes);
    if (check.damage) return damaged_at(file, *check.damage);
    return UnfinishedWrite{file, check.whole_bytes, bytes->size() - check.whole_bytes};
}

using Logs = std::map<std::uint64_t, fs::path>;

/// Returns the logs by ascending number, so the last one is the newest. The others were synced completely, and RocksDB
/// recorded their sizes in its manifest.
Logs write_ahead_logs(const fs::path& directory) {
    Logs logs;
    for (const auto& file : regular_files(directory, ".log")) {
        if (const auto number = parse_number<std::uint64_t>(file.stem().native())) logs.emplace(*number, file);
    }
    return logs;
}

Result<> cut_off(const fs::path& file, std::size_t bytes) {
    std::error_code problem;
    fs::resize_file(file, bytes, problem);
    if (!problem) return sync_file(file);
    return failure("cannot cut the unfinished write off {} of the store: {}", file.native(), problem.message());
}

} // namespace

Result<> check_newest_log(const fs::path& directory) {
    const auto logs = write_ahead_logs(directory);
    std::error_code problem;
    if (logs.empty() || fs::file_size(logs.rbegin()->second, problem) > 0 || problem) return {};
    std::ifstream in(directory / "CURRENT");
    std::string manifest;
    if (!(in >> manifest) || !manifest.starts_with(kManifest)) return {}; // a new store
    const auto number = parse_number<std::uint64_t>(std::string_view(manifest).substr(kManifest.size()));
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
    std::optional<UnfinishedWrite> unfinished;
    for (const auto& [number, log] : write_ahead_logs(directory.path())) {
        if (unfinished) return damaged_at(unfinished->file, unfinished->whole_bytes);
        const auto check = checked(log);
        if (!check) return check.error();
        if (check->bytes > 0) unfinished = *check;
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
