#pragma once

#include "server/store/files.hpp"
#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

/// Backups of a store, in RocksDB's format.
/// Source: RocksDB 7.8, utilities/backup_engine.h.
namespace scanloom::store {

/// One saved state of a store.
struct Backup {
    std::uint32_t id = 0;     ///< from 1, ascending
    double time = 0.0;        ///< seconds since the epoch
    std::uint64_t bytes = 0;  ///< size of the store; tables are shared with other backups
    std::size_t sessions = 0; ///< sessions in the store

    friend bool operator==(const Backup&, const Backup&) = default;
};

/// Makes and lists backups of a store that is in use, in a separate directory.
///
/// Each backup captures the store at one moment and contains everything acknowledged before the backup began. Tables
/// never change, so each table is copied once and shared by all backups that contain it. Every file is synced, then
/// read back and compared with its checksum. Every call reads the directory again, because its disk may be unmounted
/// and mounted while the server runs.
/// Threads: any; stop() does not block.
class Backups {
public:
    /// Limit of the copy rate, so that robots need not wait for the disk.
    static constexpr std::uint64_t kBytesPerSecond = std::uint64_t{100} << 20;

    /// Receives a message for the operator.
    using Report = std::function<void(const std::string&)>;

    /// Opens the directory, creates it if needed, and locks it against other servers during the object's lifetime. The
    /// lock does not keep restore_backup() out.
    /// @param kept  number of newest backups to keep; less than 1 counts as 1
    /// @param report  called by list() and make() with the backups that no longer exist; may be null
    /// Errors: kConflict: another server uses the directory, or it has backups of another store than `log`;
    ///         kStoreFailed: the directory cannot be used; kInvalidField: this kind of log has no backups.
    [[nodiscard]] static Result<std::unique_ptr<Backups>> open(const std::filesystem::path& directory, std::size_t kept,
                                                               ScanLog& log, Report report = {});

    /// Makes a backup of `log` and deletes the oldest backups until kept() remain. Copies only new files and waits for
    /// both disks. Creates the directory again if it was removed or emptied.
    /// Errors: kConflict: another make() is running, another server has taken the directory, or it has backups of
    ///         another store; kShuttingDown: stop() was called; kInvalidField: this kind of log has no backups;
    ///         kStoreFailed: the directory is on another disk than at open(), or a disk fails. A failed backup leaves
    ///         no files.
    [[nodiscard]] Result<Backup> make(ScanLog& log);

    /// Returns the backups in the directory by ascending id. While make() runs, returns the list from before it began.
    /// Errors: kStoreFailed: the directory is on another disk than at open(), or the disk fails.
    [[nodiscard]] Result<std::vector<Backup>> list();

    [[nodiscard]] std::size_t kept() const noexcept { return kept_; }

    /// Makes the current make() and every later one end soon with kShuttingDown.
    void stop();

private:
    Backups(std::filesystem::path directory, std::size_t kept, Report report);
    [[nodiscard]] Result<> take_directory();
    [[nodiscard]] Result<> check_disk() const;
    [[nodiscard]] Result<std::vector<Backup>> delete_old() const;
    void set_making(bool making, const Result<std::vector<Backup>>& found);
    void report_lost(const std::vector<Backup>& found) const;

    const std::filesystem::path directory_;
    const std::size_t kept_;
    const Report report_;
    std::uint64_t disk_ = 0;         // of the directory when it was opened
    std::optional<FileLock> lock_;   // guarded by making_, like locked_
    std::optional<HeldFile> locked_; // the lock file
    std::mutex making_;              // held during make()
    std::mutex state_mutex_;         // guards the members below
    std::vector<Backup> last_;       // as last listed
    bool is_making_ = false;         // whether make() is running
    std::uint64_t changes_ = 0;      // counts starts and ends of make()
    std::stop_source stopping_;      // not guarded
};

/// Restores a backup into a new store, verifies each file's checksum, and opens the store once.
/// @param directory  directory of the backups
/// @param id         nullopt: the newest
/// @param store      directory of the new store; must be empty or not exist
/// Errors: kNotFound: no such backup; kConflict: `store` is not empty; kStoreFailed: a file of the backup is damaged,
///         or the disk has no room. After a failure the caller has to delete the partial store.
[[nodiscard]] Result<Backup> restore_backup(const std::filesystem::path& directory, std::optional<std::uint32_t> id,
                                            const std::filesystem::path& store, const StoreOptions& options = {});

} // namespace scanloom::store
