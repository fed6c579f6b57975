#include "server/store/unfinished_store.hpp"

#include "server/store/directory.hpp"
#include "server/store/files.hpp"
#include "server/store/rocksdb_scan_log.hpp"

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSentence = "A store is being written into this directory. It is incomplete until this "
                                       "file is removed.";
constexpr std::string_view kSentenceEnd = "It is incomplete until this file is removed."; // in all releases
constexpr std::string_view kLogEnding = ".scanlog";

Error not_empty(const fs::path& directory, std::string_view file) {
    return {Errc::kConflict, fmt::format("{}: it is not empty ({}); name a directory that does not exist yet",
                                         directory.native(), file)};
}

/// Whether a repair or a copy may have created the file; false for the mark.
bool is_ours(const fs::path& file) {
    const auto name = file.filename().native();
    std::error_code none;
    return name != kUnfinishedFile && is_store_file(name) && fs::is_regular_file(fs::symlink_status(file, none));
}

bool is_lost_log(const fs::path& file) {
    std::error_code none;
    return file.extension() == kLogEnding && fs::is_regular_file(fs::symlink_status(file, none));
}

/// Returns what a killed repair or copy left in a directory. Other files are an error.
Result<std::vector<fs::path>> leftovers_in(const fs::path& directory, bool (*may_be_left)(const fs::path&)) {
    std::vector<fs::path> found;
    std::error_code problem;
    if (!fs::exists(directory, problem)) return found;
    fs::directory_iterator file(directory, problem);
    for (; !problem && file != fs::directory_iterator(); file.increment(problem)) {
        const auto name = file->path().filename().native();
        if (name == kUnfinishedFile) continue;
        if (!may_be_left(file->path())) return not_empty(directory, name);
        found.push_back(file->path());
    }
    if (problem) {
        return Error{Errc::kConflict, fmt::format("{}: it cannot be used: {}; name a directory that does not exist yet",
                                                  directory.native(), problem.message())};
    }
    return found;
}

bool nothing(const fs::path&) { return false; }

Result<> check_empty(const fs::path& directory, const fs::path& lost) {
    for (const auto& made : {directory, lost}) {
        if (auto found = leftovers_in(made, nothing); !found) return found.error();
    }
    return {};
}

bool says_unfinished(const fs::path& mark) {
    std::ifstream in(mark);
    std::string line;
    return std::getline(in, line) && line.ends_with(kSentenceEnd);
}

Result<> remove_leftovers(const fs::path& directory, const fs::path& lost) {
    auto found = leftovers_in(directory, is_ours);
    if (!found) return found.error();
    const auto logs = leftovers_in(lost, is_lost_log);
    if (!logs) return logs.error();
    found->insert(found->end(), logs->begin(), logs->end());
    for (const auto& file : *found) {
        std::error_code problem;
        fs::remove_all(file, problem);
        if (problem) {
            return Error{Errc::kStoreFailed,
                         fmt::format("cannot remove {}, which an interrupted repair or copy left: {}", file.native(),
                                     problem.message())};
        }
    }
    return {};
}

Result<> sync_logs(const fs::path& lost) {
    std::error_code none;
    if (!fs::is_directory(lost, none)) return {};
    for (const auto& file : fs::directory_iterator(lost)) {
        if (auto synced = sync_file(file.path()); !synced) return synced;
    }
    if (auto synced = sync_directory(lost); !synced) return synced;
    return sync_directory(lost.parent_path());
}

} // namespace

Result<UnfinishedStore> UnfinishedStore::begin(const fs::path& directory, const fs::path& lost) {
    const auto mark = directory / kUnfinishedFile;
    std::error_code none;
    if (!fs::exists(mark, none)) { // before anything is written there
        if (auto empty = check_empty(directory, lost); !empty) return empty.error();
    }
    if (auto created = create_store_directory(directory); !created) return created.error();
    auto lock = FileLock::exclusive(mark);
    if (!lock && lock.error().code == Errc::kConflict) {
        return Error{Errc::kConflict,
                     fmt::format("{}: another program is writing a store into it; wait until it ends, or name another "
                                 "directory",
                                 directory.native())};
    }
    if (!lock) return lock.error();
    // The lock excludes others from here on. Only the sentence in the mark shows who created the files.
    if (says_unfinished(mark)) {
        if (auto removed = remove_leftovers(directory, lost); !removed) return removed.error();
    } else if (auto empty = check_empty(directory, lost); !empty) {
        fs::remove(mark, none);
        return empty.error();
    }
    if (auto marked = write_mark(mark, kSentence); !marked) return marked.error();
    return UnfinishedStore(directory, lost, *std::move(lock));
}

Result<std::unique_ptr<ScanLog>> UnfinishedStore::open_log() const {
    StoreOptions options;
    options.disk_reserve_bytes = 0; // no other writer: the store either fits or does not
    return RocksdbScanLog::open(directory_, LockedDirectory::Files::kUnfinished, options);
}

Result<> UnfinishedStore::finish() {
    if (auto synced = sync_logs(lost_); !synced) return synced;
    if (auto synced = sync_directory(directory_); !synced) return synced;
    return remove_mark(directory_ / kUnfinishedFile);
}

} // namespace scanloom::store
