#pragma once

#include "server/store/file_lock.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
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
/// What is in the directory is looked at each time: a disk comes and goes under a server that runs.
/// Thread  any; stop() waits for nothing.
/// Source  RocksDB 7.8, utilities/backup_engine.h.
class Backups {
public:
    static constexpr std::uint64_t kBytesPerSecond = std::uint64_t{100} << 20; ///< copied, so that robots do not wait

    /// A sentence for whoever runs the server.
    using Tell = std::function<void(const std::string&)>;

    /// Creates the directory if need be; keeps the newest `kept` backups, at least 1. No other server can use it for
    /// as long as this lives; whoever restores can.
    /// @param tell  what became of backups that were there and are no more; called by list() and make().
    /// Errors  kConflict: another server uses the directory, or it has backups of another store than `log`;
    ///         kStoreFailed: it cannot be used; kInvalidField: the log is not kept on a disk.
    [[nodiscard]] static Result<std::unique_ptr<Backups>> open(const std::filesystem::path& directory, std::size_t kept,
                                                               ScanLog& log, Tell tell = {});
    ~Backups();
    Backups(const Backups&) = delete;
    Backups& operator=(const Backups&) = delete;

    /// Makes one, and drops the oldest ones. Copies what is new: waits for both disks. Where the directory has been
    /// removed or emptied it is made again.
    /// Errors  kConflict: another is being made, another server uses the directory meanwhile, or it has backups of
    ///         another store; kShuttingDown: stop() was called; kInvalidField: the log is not kept on a disk;
    ///         kStoreFailed: another disk is there than at first, or it fails; nothing is left of the backup.
    [[nodiscard]] Result<Backup> make(ScanLog& log);

    /// By rising id, as they are there now; while one is made, as they were before.
    /// Errors  kStoreFailed: another disk is there than at first, or it fails.
    [[nodiscard]] Result<std::vector<Backup>> list();

    [[nodiscard]] std::size_t kept() const noexcept { return kept_; }

    /// Has make() end soon, for good.
    void stop();

private:
    /// Of whatever name.
    struct FileId {
        std::uint64_t disk = 0;
        std::uint64_t inode = 0;

        friend bool operator==(const FileId&, const FileId&) = default;
    };

    Backups(std::filesystem::path directory, std::size_t kept, Tell tell);
    [[nodiscard]] static std::optional<FileId> id_of(const std::filesystem::path& file);
    [[nodiscard]] static std::uint64_t disk_of(const std::filesystem::path& directory);
    [[nodiscard]] Result<> take_directory();
    [[nodiscard]] Result<> check_disk() const;
    [[nodiscard]] Result<std::shared_ptr<rocksdb::BackupEngine>> open_engine();
    [[nodiscard]] Result<Backup> make_with(rocksdb::BackupEngine& engine, ScanLog& log, std::size_t sessions);
    void begin_with(std::shared_ptr<rocksdb::BackupEngine> engine);
    void end_with(std::vector<Backup> found);
    void tell_lost(const std::vector<Backup>& found) const;

    const std::filesystem::path directory_;
    const std::size_t kept_;
    const Tell tell_;
    std::uint64_t disk_ = 0;                        // on which the directory was at first
    std::optional<FileLock> lock_;                  // guarded by making_, as the next
    std::optional<FileId> locked_;                  // the file of the lock
    std::mutex making_;                             // held by who makes one
    std::mutex state_mutex_;                        // guards what follows
    std::vector<Backup> last_;                      // when they were looked at last
    std::shared_ptr<rocksdb::BackupEngine> engine_; // null: none is being made
    std::uint64_t changes_ = 0;                     // beginnings and ends of make()
    bool stopped_ = false;
};

/// Writes the store as a backup has it, checking each file's checksum, and opens it once.
/// @param id  nothing: the newest.
/// Errors  kNotFound: no such backup; kConflict: `store` is not empty; kStoreFailed: a file of the backup is damaged,
///         or the disk cannot take it; what there is of the new store is to be deleted.
[[nodiscard]] Result<Backup> restore_backup(const std::filesystem::path& directory, std::optional<std::uint32_t> id,
                                            const std::filesystem::path& store, const StoreOptions& options = {});

} // namespace scanloom::store
