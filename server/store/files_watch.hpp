#pragma once

#include "common/error/error.hpp"
#include "server/store/files.hpp"

#include <rocksdb/db.h>

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>

namespace scanloom::store {

/// Detects that the files of an open store were deleted, moved or replaced.
///
/// RocksDB does not detect this: it continues to write to deleted files, creates files by path, and deletes unknown
/// files by path, including those of a store that another server created in the same place.
/// Threads: any.
class FilesWatch {
public:
    /// @param database   of the store; must outlive this
    /// @param directory  of the store; has a lock file
    FilesWatch(rocksdb::DB& database, std::filesystem::path directory);

    /// Checks that the paths of the lock file and of the current write-ahead log lead to the files that this process
    /// has open. If not, stops RocksDB's background work and file deletions permanently. Files that cannot be examined,
    /// for example for lack of file descriptors, count as being in place.
    /// Errors: kStoreFailed: the store is not in its place, now or at an earlier check.
    [[nodiscard]] Result<> check();

private:
    [[nodiscard]] bool has_its_log();
    void give_up(const std::filesystem::path& missing);

    rocksdb::DB& database_;
    const std::filesystem::path directory_;
    std::mutex mutex_; // guards the members below
    std::optional<HeldFile> lock_;
    std::uint64_t log_number_ = 0;
    std::optional<HeldFile> log_;
    std::optional<Error> lost_;
};

} // namespace scanloom::store
