#include "server/store/backups.hpp"

#include "server/store/backup_engine.hpp"
#include "server/store/rocksdb_scan_log.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/utilities/backup_engine.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include <sys/stat.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

/// Lists the backups that restore_backup() would find.
Result<std::vector<Backup>> read_backups(const fs::path& directory) {
    std::error_code none;
    if (!fs::exists(directory / "meta", none)) return std::vector<Backup>{};
    const auto engine = open_engine<rocksdb::BackupEngineReadOnly>(directory);
    if (!engine) return engine.error();
    return backups_of(**engine);
}

Result<Backup> find(rocksdb::BackupEngineReadOnly& engine, const fs::path& directory, std::optional<std::uint32_t> id) {
    const auto infos = infos_of(engine);
    if (infos.empty()) return Error{Errc::kNotFound, fmt::format("there is no backup in {}", directory.native())};
    if (!id) return backup_of(infos.back());
    const auto found = std::ranges::find(infos, *id, &rocksdb::BackupInfo::backup_id);
    if (found != infos.end()) return backup_of(*found);
    return Error{Errc::kNotFound, fmt::format("there is no backup {} in {}; there are {} to {}", *id,
                                              directory.native(), infos.front().backup_id, infos.back().backup_id)};
}

Result<> check_empty(const fs::path& store) {
    std::error_code problem;
    if (!fs::exists(store, problem) || (fs::is_directory(store, problem) && fs::is_empty(store, problem))) return {};
    return Error{Errc::kConflict,
                 fmt::format("{} is not empty; name a directory that does not exist yet", store.native())};
}

/// Returns the device that holds the directory, or that would hold it if it were created; 0 if it is unknown.
std::uint64_t disk_of(const fs::path& directory) {
    std::error_code none;
    struct stat found = {};
    for (auto place = fs::absolute(directory, none);; place = place.parent_path()) {
        if (::stat(place.c_str(), &found) == 0) return found.st_dev;
        if (!place.has_relative_path()) return 0;
    }
}

} // namespace

Result<std::unique_ptr<Backups>> Backups::open(const fs::path& directory, std::size_t kept, ScanLog& log,
                                               Report report) {
    const auto identity = log.identity();
    if (!identity) return identity.error();
    std::unique_ptr<Backups> backups(new Backups(directory, kept, std::move(report)));
    if (auto taken = backups->take_directory(); !taken) return taken.error();
    backups->disk_ = disk_of(directory);
    const auto engine = open_engine<rocksdb::BackupEngine>(directory);
    if (!engine) return engine.error();
    if (auto owned = check_owner(**engine, directory, *identity); !owned) return owned.error();
    // Removes what a crash left of a backup. If it stays, it only uses disk space.
    (*engine)->GarbageCollect().PermitUncheckedError();
    backups->last_ = backups_of(**engine);
    return backups;
}

Backups::Backups(fs::path directory, std::size_t kept, Report report)
    : directory_(std::move(directory)), kept_(std::max<std::size_t>(kept, 1)), report_(std::move(report)) {}

/// Locks the directory again if the lock file was removed: such a lock excludes no other server.
Result<> Backups::take_directory() {
    std::error_code problem;
    fs::create_directories(directory_, problem);
    if (problem)
        return failure("cannot create the directory of backups {}: {}", directory_.native(), problem.message());
    const auto file = directory_ / "scanloom.lock";
    if (lock_ && locked_->is_in_place()) return {};
    auto lock = FileLock::exclusive(file);
    if (!lock && lock.error().code == Errc::kConflict) {
        return Error{Errc::kConflict, fmt::format("the directory of backups {} is in use by another scanloom-server; "
                                                  "name another directory",
                                                  directory_.native())};
    }
    if (!lock) return failure("the backups in {} cannot be used: {}", directory_.native(), lock.error().message);
    auto locked = HeldFile::open(file);
    if (!locked) return locked.error();
    lock_ = *std::move(lock);
    locked_ = *std::move(locked);
    return {};
}

/// A backup in the mount point's own directory would fill the wrong disk and be hidden once the right one is mounted
/// again. A disk may have another device number after it is mounted again, but then it holds backups.
Result<> Backups::check_disk() const {
    std::error_code none;
    if (disk_of(directory_) == disk_ || fs::is_directory(directory_ / "meta", none)) return {};
    return failure("the directory of backups {} is on another disk than when the server started; mount the right one "
                   "again, or restart the server to take this one",
                   directory_.native());
}

Result<Backup> Backups::make(ScanLog& log) {
    const std::unique_lock making(making_, std::try_to_lock);
    if (!making) return Error{Errc::kConflict, "a backup is being made at this moment; wait for its end"};
    if (auto there = check_disk(); !there) return there.error();
    if (auto taken = take_directory(); !taken) return taken.error();
    set_making(true, read_backups(directory_));
    const auto made = log.backup_to(directory_, stopping_.get_token());
    const auto after = made ? delete_old() : read_backups(directory_);
    set_making(false, after);
    if (!made) return made.error();
    if (!after) return after.error();
    return after->back();
}

/// Deletes the oldest backups. If that fails, the next backup retries.
/// @return the remaining ones
Result<std::vector<Backup>> Backups::delete_old() const {
    const auto engine = open_engine<rocksdb::BackupEngine>(directory_);
    if (!engine) return engine.error();
    (*engine)->PurgeOldBackups(static_cast<std::uint32_t>(kept_)).PermitUncheckedError();
    return backups_of(**engine);
}

/// @param found  the backups at the start or at the end of make()
void Backups::set_making(bool making, const Result<std::vector<Backup>>& found) {
    const std::lock_guard lock(state_mutex_);
    if (making && found) report_lost(*found); // before make() deletes any
    is_making_ = making;
    if (found) last_ = *found;
    ++changes_;
}

void Backups::report_lost(const std::vector<Backup>& found) const {
    std::string lost;
    for (const auto& backup : last_) {
        if (std::ranges::find(found, backup.id, &Backup::id) != found.end()) continue;
        lost += fmt::format("{}{}", lost.empty() ? "" : ", ", backup.id);
    }
    if (lost.empty() || !report_) return;
    report_(fmt::format("the directory of backups {} has lost the backups {}: they were removed, or are damaged",
                        directory_.native(), lost));
}

Result<std::vector<Backup>> Backups::list() {
    if (auto there = check_disk(); !there) return there.error();
    std::uint64_t changes = 0;
    {
        const std::lock_guard lock(state_mutex_);
        if (is_making_) return last_;
        changes = changes_;
    }
    auto found = read_backups(directory_);
    if (!found) return found;
    const std::lock_guard lock(state_mutex_);
    if (changes != changes_) return last_; // a backup was made meanwhile, or is being made
    report_lost(*found);
    last_ = *found;
    return found;
}

void Backups::stop() { stopping_.request_stop(); }

Result<Backup> restore_backup(const fs::path& directory, std::optional<std::uint32_t> id, const fs::path& store,
                              const StoreOptions& options) {
    if (auto empty = check_empty(store); !empty) return empty.error();
    const auto engine = open_engine<rocksdb::BackupEngineReadOnly>(directory);
    if (!engine) return Error{Errc::kNotFound, engine.error().message};
    const auto backup = find(**engine, directory, id);
    if (!backup) return backup.error();
    std::error_code problem;
    fs::create_directories(store, problem);
    if (problem) return failure("cannot create the store {}: {}", store.native(), problem.message());
    if (const auto restored = (*engine)->RestoreDBFromBackup(backup->id, store.native(), store.native());
        !restored.ok()) {
        return failure("backup {} cannot be restored into {}: {}; delete what there is of it, and try another one",
                       backup->id, store.native(), restored.ToString());
    }
    // A store that has written nothing since its last table has no write-ahead log to copy. Opening it creates one, but
    // a complete store has one.
    if (auto log = RocksdbScanLog::open(store, LockedDirectory::Files::kDamaged, options); !log) return log.error();
    return *backup;
}

} // namespace scanloom::store
