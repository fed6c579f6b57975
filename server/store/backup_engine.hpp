#pragma once

#include "server/store/backups.hpp"

#include <rocksdb/db.h>
#include <rocksdb/utilities/backup_engine.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

/// RocksDB's backup engine with Scanloom's options and metadata.
/// Source: RocksDB 7.8, utilities/backup_engine.h.
namespace scanloom::store {

/// Opens a directory of backups for writing; creates it if needed.
/// Errors: kStoreFailed: it cannot be used.
[[nodiscard]] Result<std::unique_ptr<rocksdb::BackupEngine>> open_engine(const std::filesystem::path& directory);

/// Opens a directory of backups for reading.
/// Errors: kStoreFailed: it cannot be read.
[[nodiscard]] Result<std::unique_ptr<rocksdb::BackupEngineReadOnly>>
open_engine_to_read(const std::filesystem::path& directory);

/// Stored with each backup; backups of earlier versions lack `store`.
struct BackupMetadata {
    std::size_t sessions = 0;
    std::string store; ///< identity of the store; empty: unknown
};

[[nodiscard]] BackupMetadata metadata_of(const rocksdb::BackupInfo& info);

[[nodiscard]] Backup backup_of(const rocksdb::BackupInfo& info);

/// Returns the intact backups by ascending id; damaged ones are omitted.
[[nodiscard]] std::vector<rocksdb::BackupInfo> infos_of(const rocksdb::BackupEngineReadOnlyBase& engine);
[[nodiscard]] std::vector<Backup> backups_of(const rocksdb::BackupEngineReadOnlyBase& engine);

/// Returns the identity of a store; see ScanLog::identity().
/// Errors: kStoreFailed.
[[nodiscard]] Result<std::string> identity_of(rocksdb::DB& database);

/// Checks that all backups are of the store with this identity. Otherwise `--restore newest` would restore another
/// store.
/// @param directory  of the backups, for the message
/// Errors: kConflict: one is of another store.
[[nodiscard]] Result<> check_owner(const rocksdb::BackupEngine& engine, const std::filesystem::path& directory,
                                   const std::string& identity);

/// Makes a backup and compares its files with their checksums.
/// @param sessions  number of sessions in the store, kept with the backup
/// Errors: those of ScanLog::backup_to().
[[nodiscard]] Result<> back_up(rocksdb::DB& database, const std::filesystem::path& directory, std::size_t sessions,
                               const std::stop_token& stop);

} // namespace scanloom::store
