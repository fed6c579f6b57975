#include "server/store/backup_engine.hpp"
#include "server/store/compaction.hpp"
#include "server/store/rocksdb_options.hpp"

#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/db.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

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

/// A store that has written nothing since its last table has no write-ahead log to copy, but a store without a log
/// counts as damaged. Opening it creates one.
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
