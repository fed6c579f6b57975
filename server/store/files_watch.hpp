#pragma once

#include "common/error/error.hpp"
#include "server/store/held_file.hpp"

#include <rocksdb/db.h>

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>

namespace scanloom::store {

/// Notices that the files of an open store were deleted, moved or replaced.
///
/// RocksDB does not: it goes on writing to deleted files, creates files by path, and deletes unknown files by path,
/// also those of a store that another server created in the same place.
/// Thread  any.
class FilesWatch {
public:
    /// @param database   of the store; must outlive this
    /// @param directory  of the store; it has a lock file
    FilesWatch(rocksdb::DB& database, std::filesystem::path directory);

    /// Checks that the paths of the lock file and of the current write-ahead log lead to the files that this process
    /// has open. If not, stops RocksDB's background work and its deleting of files, for good.
    /// Files that cannot be looked at, for want of descriptors for example, count as being in place.
    /// Errors  kStoreFailed: the store is not in its place, now or at an earlier check.
    [[nodiscard]] Result<> check();

private:
    [[nodiscard]] bool has_its_log();
    void give_up(const std::filesystem::path& missing);

    rocksdb::DB& database_;
    const std::filesystem::path directory_;
    std::mutex mutex_; // guards what follows
    std::optional<HeldFile> lock_;
    std::uint64_t log_number_ = 0;
    std::optional<HeldFile> log_;
    std::optional<Error> lost_;
};

} // namespace scanloom::store
