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
/// RocksDB does not: it goes on writing to deleted files, creates new ones by path, and deletes by path what it does
/// not know, also in the store of another server that was created in the same place.
/// Thread  any.
class FilesWatch {
public:
    /// @param database   of the store; must outlive this
    /// @param directory  of the store; it has a lock file
    FilesWatch(rocksdb::DB& database, std::filesystem::path directory);

    /// Checks that the paths of the lock file and of the current write-ahead log lead to the files that this process
    /// has open. If not, stops RocksDB's background work and its deleting of files, for good.
    /// Errors  kStoreFailed: the store is not in its place, now or at an earlier check.
    [[nodiscard]] Result<> check();

private:
    [[nodiscard]] bool has_its_lock() const { return lock_ && lock_->is_in_place(); }
    [[nodiscard]] bool has_its_log();
    void give_up(const std::filesystem::path& missing);

    rocksdb::DB& database_;
    const std::filesystem::path directory_;
    const std::optional<HeldFile> lock_;
    std::mutex mutex_; // guards what follows
    std::uint64_t log_number_ = 0;
    std::optional<HeldFile> log_;
    std::optional<Error> lost_;
};

} // namespace scanloom::store
