#pragma once

#include "common/error/error.hpp"
#include "server/store/backups.hpp"
#include "server/store/store_error.hpp"

#include <rocksdb/db.h>
#include <rocksdb/utilities/backup_engine.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

/// RocksDB's backup engine, as Backups and ScanLog::backup_to() use it.
/// Source: RocksDB 7.8, utilities/backup_engine.h.
namespace scanloom::store {

/// Returns the options of the engine for a directory of backups.
[[nodiscard]] rocksdb::BackupEngineOptions engine_options(const std::filesystem::path& directory);

/// Opens the engine for a directory of backups.
/// @tparam Engine  rocksdb::BackupEngine or rocksdb::BackupEngineReadOnly
/// Errors: kStoreFailed.
template <class Engine>
[[nodiscard]] Result<std::unique_ptr<Engine>> open_engine(const std::filesystem::path& directory) {
    Engine* opened = nullptr;
    const auto status = Engine::Open(engine_options(directory), rocksdb::Env::Default(), &opened);
    std::unique_ptr<Engine> engine(opened);
    if (status.ok()) return engine;
    return failure("the backups in {} cannot be opened: {}; name another directory", directory.native(),
                   status.ToString());
}

/// Converts the description of a backup.
[[nodiscard]] Backup backup_of(const rocksdb::BackupInfo& info);

/// Returns the intact backups by ascending id; damaged ones are omitted.
[[nodiscard]] std::vector<rocksdb::BackupInfo> infos_of(const rocksdb::BackupEngineReadOnlyBase& engine);

/// Returns the intact backups by ascending id, converted.
[[nodiscard]] std::vector<Backup> backups_of(const rocksdb::BackupEngineReadOnlyBase& engine);

/// Checks that all backups are of the store with this identity. Otherwise `--restore newest` would restore another
/// store.
/// Errors: kConflict: one is of another store.
[[nodiscard]] Result<> check_owner(const rocksdb::BackupEngine& engine, const std::filesystem::path& directory,
                                   const std::string& identity);

/// Returns the identity of a store; see ScanLog::identity().
/// Errors: kStoreFailed.
[[nodiscard]] Result<std::string> identity_of(rocksdb::DB& database);

/// Makes a backup and compares its files with their checksums.
/// @param sessions  number of sessions in the store, kept with the backup
/// Errors: those of ScanLog::backup_to().
[[nodiscard]] Result<> back_up(rocksdb::DB& database, const std::filesystem::path& directory, std::size_t sessions,
                               const std::stop_token& stop);

} // namespace scanloom::store
