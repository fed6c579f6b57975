#include "server/store/backups.hpp"

#include "server/store/backup_engine.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/db.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include <sys/stat.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

Result<std::string> identity_of(rocksdb::DB& database) {
    std::string identity;
    if (const auto status = database.GetDbIdentity(identity); !status.ok()) {
        return failure("the identity of the store cannot be read: {}", status.ToString());
    }
    return identity;
}

Result<std::string> identity_of(ScanLog& log) {
    std::string identity;
    const auto read = log.copy_with([&](rocksdb::DB& database) -> Result<> {
        auto found = identity_of(database);
        if (!found) return found.error();
        identity = std::move(*found);
        return {};
    });
    if (!read) return read.error();
    return identity;
}

/// Otherwise `--restore newest` would restore another store.
Result<> check_owner(const rocksdb::BackupEngine& engine, const fs::path& directory, const std::string& identity) {
    for (const auto& info : infos_of(engine)) {
        const auto owner = metadata_of(info).store;
        if (owner.empty() || owner == identity) continue;
        return Error{Errc::kConflict,
                     fmt::format("the directory of backups {} has backups of another store (backup {}); "
                                 "name another directory, one for each store",
                                 directory.native(), info.backup_id)};
    }
    return {};
}

} // namespace

Result<std::unique_ptr<Backups>> Backups::open(const fs::path& directory, std::size_t kept, ScanLog& log, Tell tell) {
    const auto identity = identity_of(log);
    if (!identity) return identity.error();
    std::unique_ptr<Backups> backups(new Backups(directory, kept, std::move(tell)));
    if (auto taken = backups->take_directory(); !taken) return taken.error();
    backups->disk_ = disk_of(directory);
    const auto engine = backups->open_engine();
    if (!engine) return engine.error();
    if (auto owned = check_owner(**engine, directory, *identity); !owned) return owned.error();
    // Removes what a crash left of a backup. If it stays, it only uses disk space.
    (*engine)->GarbageCollect().PermitUncheckedError();
    backups->last_ = backups_of(**engine);
    return backups;
}

Backups::Backups(fs::path directory, std::size_t kept, Tell tell)
    : directory_(std::move(directory)), kept_(std::max<std::size_t>(kept, 1)), tell_(std::move(tell)) {}

Backups::~Backups() = default;

std::optional<Backups::FileId> Backups::id_of(const fs::path& file) {
    struct stat found = {};
    if (::stat(file.c_str(), &found) != 0) return {};
    return FileId{found.st_dev, found.st_ino};
}

/// Returns the device that holds the directory, or that would hold it if it were created.
std::uint64_t Backups::disk_of(const fs::path& directory) {
    std::error_code none;
    auto place = fs::absolute(directory, none);
    auto found = id_of(place);
    for (; !found && place.has_relative_path(); found = id_of(place)) place = place.parent_path();
    return found ? found->disk : 0;
}

/// Locks the directory again if the lock file was removed: such a lock excludes no other server.
Result<> Backups::take_directory() {
    std::error_code problem;
    fs::create_directories(directory_, problem);
    if (problem)
        return failure("cannot create the directory of backups {}: {}", directory_.native(), problem.message());
    const auto file = directory_ / "scanloom.lock";
    if (lock_ && id_of(file) == locked_) return {};
    auto lock = FileLock::exclusive(file);
    if (!lock && lock.error().code == Errc::kConflict) {
        return Error{Errc::kConflict, fmt::format("the directory of backups {} is in use by another scanloom-server; "
                                                  "name another directory",
                                                  directory_.native())};
    }
    if (!lock) return failure("the backups in {} cannot be used: {}", directory_.native(), lock.error().message);
    lock_.emplace(*std::move(lock));
    locked_ = id_of(file);
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

Result<std::shared_ptr<rocksdb::BackupEngine>> Backups::open_engine() {
    rocksdb::BackupEngine* opened = nullptr;
    const auto status = rocksdb::BackupEngine::Open(rocksdb::Env::Default(), engine_options(directory_), &opened);
    std::shared_ptr<rocksdb::BackupEngine> engine(opened);
    if (status.ok()) return engine;
    return failure("the backups in {} cannot be used: {}; name another directory", directory_.native(),
                   status.ToString());
}

Result<Backup> Backups::make(ScanLog& log) {
    const std::unique_lock making(making_, std::try_to_lock);
    if (!making) return Error{Errc::kConflict, "a backup is being made at this moment; wait for its end"};
    const auto sessions = log.sessions();
    if (!sessions) return sessions.error();
    if (auto there = check_disk(); !there) return there.error();
    if (auto taken = take_directory(); !taken) return taken.error();
    const auto engine = open_engine();
    if (!engine) return engine.error();
    begin_with(*engine);
    auto made = make_with(**engine, log, sessions->size());
    end_with(backups_of(**engine));
    return made;
}

void Backups::begin_with(std::shared_ptr<rocksdb::BackupEngine> engine) {
    const std::lock_guard lock(state_mutex_);
    tell_lost(backups_of(*engine)); // before make() deletes any
    engine_ = std::move(engine);
    ++changes_;
    if (stopped_) engine_->StopBackup();
}

void Backups::end_with(std::vector<Backup> found) {
    const std::lock_guard lock(state_mutex_);
    last_ = std::move(found);
    engine_.reset();
    ++changes_;
}

Result<Backup> Backups::make_with(rocksdb::BackupEngine& engine, ScanLog& log, std::size_t sessions) {
    rocksdb::BackupID id = 0;
    auto made = log.copy_with([&](rocksdb::DB& database) -> Result<> {
        const auto identity = identity_of(database);
        if (!identity) return identity.error();
        if (auto owned = check_owner(engine, directory_, *identity); !owned) return owned;
        rocksdb::CreateBackupOptions options;
        options.flush_before_backup = true; // otherwise each backup would copy entries of the write-ahead log again
        auto status =
            engine.CreateNewBackupWithMetadata(options, &database, fmt::format("{} {}", sessions, *identity), &id);
        if (status.ok()) status = engine.VerifyBackup(id, true);
        if (status.ok()) return {};
        if (id != 0) engine.DeleteBackup(id).PermitUncheckedError();
        if (status.IsIncomplete()) return Error{Errc::kShuttingDown, "the server is shutting down: no backup was made"};
        return failure("no backup could be made in {}: {}", directory_.native(), status.ToString());
    });
    if (!made) return made.error();
    // If it fails, the next backup retries.
    engine.PurgeOldBackups(static_cast<std::uint32_t>(kept_)).PermitUncheckedError();
    return backups_of(engine).back();
}

void Backups::tell_lost(const std::vector<Backup>& found) const {
    std::string lost;
    for (const auto& backup : last_) {
        if (std::ranges::find(found, backup.id, &Backup::id) != found.end()) continue;
        lost += fmt::format("{}{}", lost.empty() ? "" : ", ", backup.id);
    }
    if (lost.empty() || !tell_) return;
    tell_(fmt::format("the directory of backups {} has lost the backups {}: they were removed, or are damaged",
                      directory_.native(), lost));
}

namespace {

/// Lists the backups that restore_backup() would find.
Result<std::vector<Backup>> read_backups(const fs::path& directory) {
    std::error_code none;
    if (!fs::exists(directory / "meta", none)) return std::vector<Backup>{};
    rocksdb::BackupEngineReadOnly* opened = nullptr;
    const auto status =
        rocksdb::BackupEngineReadOnly::Open(rocksdb::Env::Default(), engine_options(directory), &opened);
    const std::unique_ptr<rocksdb::BackupEngineReadOnly> engine(opened);
    if (!status.ok()) return failure("the backups in {} cannot be read: {}", directory.native(), status.ToString());
    return backups_of(*engine);
}

} // namespace

Result<std::vector<Backup>> Backups::list() {
    if (auto there = check_disk(); !there) return there.error();
    std::uint64_t changes = 0;
    {
        const std::lock_guard lock(state_mutex_);
        if (engine_ != nullptr) return last_;
        changes = changes_;
    }
    auto found = read_backups(directory_);
    if (!found) return found;
    const std::lock_guard lock(state_mutex_);
    if (changes != changes_) return last_; // a backup was made meanwhile, or is being made
    tell_lost(*found);
    last_ = *found;
    return found;
}

void Backups::stop() {
    const std::lock_guard lock(state_mutex_);
    stopped_ = true;
    if (engine_ != nullptr) engine_->StopBackup();
}

} // namespace scanloom::store
