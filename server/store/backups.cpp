#include "server/store/backups.hpp"

#include "server/store/compaction_watch.hpp"
#include "server/store/rocksdb_options.hpp"

#include <fmt/format.h>
#include <rocksdb/db.h>
#include <rocksdb/utilities/backup_engine.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

template <class... Args>
Error failure(fmt::format_string<Args...> text, Args&&... args) {
    return {Errc::kStoreFailed, fmt::format(text, std::forward<Args>(args)...)};
}

rocksdb::BackupEngineOptions engine_options(const fs::path& directory) {
    rocksdb::BackupEngineOptions options(directory.native());
    options.sync = true;
    options.share_table_files = true;
    options.share_files_with_checksum = true; // two stores may have tables of one name
    options.backup_rate_limit = Backups::kBytesPerSecond;
    return options;
}

/// How many sessions there are is kept beside each backup.
std::size_t sessions_in(const std::string& metadata) {
    std::size_t sessions = 0;
    std::from_chars(metadata.data(), metadata.data() + metadata.size(), sessions);
    return sessions;
}

Backup backup_of(const rocksdb::BackupInfo& info) {
    return {info.backup_id, static_cast<double>(info.timestamp), info.size, sessions_in(info.app_metadata)};
}

} // namespace

Result<std::unique_ptr<Backups>> Backups::open(const fs::path& directory, std::size_t kept) {
    std::error_code problem;
    fs::create_directories(directory, problem);
    if (problem) return failure("cannot create the directory of backups {}: {}", directory.native(), problem.message());
    auto lock = FileLock::alone(directory / "scanloom.lock");
    if (!lock && lock.error().code == Errc::kConflict) {
        return Error{Errc::kConflict, fmt::format("the directory of backups {} is in use by another scanloom-server; "
                                                  "name another directory",
                                                  directory.native())};
    }
    if (!lock) return failure("the backups in {} cannot be used: {}", directory.native(), lock.error().message);
    rocksdb::BackupEngine* opened = nullptr;
    const auto status = rocksdb::BackupEngine::Open(rocksdb::Env::Default(), engine_options(directory), &opened);
    std::unique_ptr<rocksdb::BackupEngine> engine(opened);
    if (!status.ok()) {
        return failure("the backups in {} cannot be used: {}; name another directory", directory.native(),
                       status.ToString());
    }
    engine->GarbageCollect().PermitUncheckedError(); // what a crash left of one; if it stays, it takes disk and no more
    return std::unique_ptr<Backups>(new Backups(directory, kept, *std::move(lock), std::move(engine)));
}

Backups::Backups(fs::path directory, std::size_t kept, FileLock lock, std::unique_ptr<rocksdb::BackupEngine> engine)
    : directory_(std::move(directory)), kept_(std::max<std::size_t>(kept, 1)), lock_(std::move(lock)),
      engine_(std::move(engine)) {
    look();
}

Backups::~Backups() = default;

Result<Backup> Backups::make(ScanLog& log) {
    const std::unique_lock making(making_, std::try_to_lock);
    if (!making) return Error{Errc::kConflict, "a backup is being made at this moment; wait for its end"};
    const auto sessions = log.sessions();
    if (!sessions) return sessions.error();
    rocksdb::BackupID id = 0;
    auto made = log.copy_with([&](rocksdb::DB& database) -> Result<> {
        rocksdb::CreateBackupOptions options;
        options.flush_before_backup = true; // what is only in the write-ahead log would be copied again each time
        auto status = engine_->CreateNewBackupWithMetadata(options, &database, std::to_string(sessions->size()), &id);
        if (status.ok()) status = engine_->VerifyBackup(id, true);
        if (status.ok()) return {};
        if (id != 0) engine_->DeleteBackup(id).PermitUncheckedError();
        if (status.IsIncomplete()) return Error{Errc::kShuttingDown, "the server is shutting down: no backup was made"};
        return failure("no backup could be made in {}: {}", directory_.native(), status.ToString());
    });
    if (!made) return made.error();
    engine_->PurgeOldBackups(static_cast<std::uint32_t>(kept_)).PermitUncheckedError(); // again with the next one
    look();
    return list().back();
}

void Backups::look() {
    std::vector<rocksdb::BackupInfo> infos;
    engine_->GetBackupInfo(&infos);
    std::vector<Backup> found;
    for (const auto& info : infos) found.push_back(backup_of(info));
    std::ranges::sort(found, {}, &Backup::id);
    const std::lock_guard lock(list_mutex_);
    list_ = std::move(found);
}

std::vector<Backup> Backups::list() const {
    const std::lock_guard lock(list_mutex_);
    return list_;
}

void Backups::stop() { engine_->StopBackup(); }

namespace {

Result<Backup> find(rocksdb::BackupEngineReadOnly& engine, const fs::path& directory, std::optional<std::uint32_t> id) {
    std::vector<rocksdb::BackupInfo> infos;
    engine.GetBackupInfo(&infos);
    if (infos.empty()) return Error{Errc::kNotFound, fmt::format("there is no backup in {}", directory.native())};
    std::ranges::sort(infos, {}, &rocksdb::BackupInfo::backup_id);
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

/// A store that had written nothing since its last table has no write-ahead log to copy, and one without is taken for
/// damaged.
Result<> complete(const fs::path& store, const StoreOptions& options) {
    for (const auto& file : fs::directory_iterator(store)) {
        if (file.path().extension() == ".log") return {};
    }
    rocksdb::DB* opened = nullptr;
    const auto status =
        rocksdb::DB::Open(rocksdb_options(options, std::make_shared<CompactionWatch>()), store.native(), &opened);
    const std::unique_ptr<rocksdb::DB> database(opened);
    if (!status.ok()) return failure("the restored store {} cannot be opened: {}", store.native(), status.ToString());
    return {};
}

} // namespace

Result<Backup> restore_backup(const fs::path& directory, std::optional<std::uint32_t> id, const fs::path& store,
                              const StoreOptions& options) {
    if (auto empty = check_empty(store); !empty) return empty.error();
    rocksdb::BackupEngineReadOnly* opened = nullptr;
    const auto status =
        rocksdb::BackupEngineReadOnly::Open(rocksdb::Env::Default(), engine_options(directory), &opened);
    const std::unique_ptr<rocksdb::BackupEngineReadOnly> engine(opened);
    if (!status.ok()) {
        return Error{Errc::kNotFound,
                     fmt::format("there are no backups in {}: {}", directory.native(), status.ToString())};
    }
    const auto backup = find(*engine, directory, id);
    if (!backup) return backup.error();
    std::error_code problem;
    fs::create_directories(store, problem);
    if (problem) return failure("cannot create the store {}: {}", store.native(), problem.message());
    if (const auto restored = engine->RestoreDBFromBackup(backup->id, store.native(), store.native()); !restored.ok()) {
        return failure("backup {} cannot be restored into {}: {}; delete what there is of it, and try another one",
                       backup->id, store.native(), restored.ToString());
    }
    if (auto completed = complete(store, options); !completed) return completed.error();
    if (auto log = open_rocksdb(store, options); !log) return log.error();
    return *backup;
}

} // namespace scanloom::store
