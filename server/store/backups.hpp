#pragma once

#include "server/store/file_lock.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace rocksdb {
class BackupEngine;
}

namespace scanloom::store {

/// One state of a store, to go back to.
struct Backup {
    std::uint32_t id = 0;     ///< from 1, rising
    double time = 0.0;        ///< seconds since the epoch
    std::uint64_t bytes = 0;  ///< of the store; tables are shared with other backups
    std::size_t sessions = 0; ///< in it

    friend bool operator==(const Backup&, const Backup&) = default;
};

/// Backups of a store that is in use, in a directory of their own.
///
/// A backup is a moment of the store: everything acknowledged before it began is in it. Tables never change, so each is
/// copied once and shared by the backups that have it. Every file is synced, and read again against its checksum.
/// Thread  any; list() and stop() wait for nothing.
/// Source  RocksDB 7.8, utilities/backup_engine.h.
class Backups {
public:
    static constexpr std::uint64_t kBytesPerSecond = std::uint64_t{100} << 20; ///< copied, so that robots do not wait

    /// Creates the directory if need be; keeps the newest `kept` backups, at least 1. No other server can use it for
    /// as long as this lives; whoever restores can.
    /// Errors  kConflict: another server uses the directory; kStoreFailed: it cannot be used.
    [[nodiscard]] static Result<std::unique_ptr<Backups>> open(const std::filesystem::path& directory,
                                                               std::size_t kept);
    ~Backups();
    Backups(const Backups&) = delete;
    Backups& operator=(const Backups&) = delete;

    /// Makes one, and drops the oldest ones. Copies what is new: waits for both disks.
    /// Errors  kConflict: another is being made; kShuttingDown: stop() was called; kInvalidField: the log is not kept
    ///         on a disk; kStoreFailed: of it nothing is left.
    [[nodiscard]] Result<Backup> make(ScanLog& log);

    /// By rising id.
    [[nodiscard]] std::vector<Backup> list() const;

    [[nodiscard]] std::size_t kept() const noexcept { return kept_; }

    /// Has make() end soon, for good.
    void stop();

private:
    Backups(std::filesystem::path directory, std::size_t kept, FileLock lock,
            std::unique_ptr<rocksdb::BackupEngine> engine);
    void look();

    const std::filesystem::path directory_;
    const std::size_t kept_;
    const FileLock lock_;
    const std::unique_ptr<rocksdb::BackupEngine> engine_;
    std::mutex making_; // held by who makes one
    mutable std::mutex list_mutex_;
    std::vector<Backup> list_; // guarded by list_mutex_
};

/// Writes the store as a backup has it, checking each file's checksum, and opens it once.
/// @param id  nothing: the newest.
/// Errors  kNotFound: no such backup; kConflict: `store` is not empty; kStoreFailed: a file of the backup is damaged,
///         or the disk cannot take it; what there is of the new store is to be deleted.
[[nodiscard]] Result<Backup> restore_backup(const std::filesystem::path& directory, std::optional<std::uint32_t> id,
                                            const std::filesystem::path& store, const StoreOptions& options = {});

} // namespace scanloom::store
