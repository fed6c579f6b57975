#pragma once

#include "server/store/backups.hpp"

#include <rocksdb/utilities/backup_engine.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace scanloom::store {

/// RocksDB's backups as Scanloom uses them.

[[nodiscard]] rocksdb::BackupEngineOptions engine_options(const std::filesystem::path& directory);

/// Kept beside each backup; those of earlier versions lack the store.
struct BackupMetadata {
    std::size_t sessions = 0;
    std::string store; ///< its identity; empty: not known
};

[[nodiscard]] BackupMetadata metadata_of(const rocksdb::BackupInfo& info);

[[nodiscard]] Backup backup_of(const rocksdb::BackupInfo& info);

/// By rising id, as the next; without those that are damaged.
[[nodiscard]] std::vector<rocksdb::BackupInfo> infos_of(const rocksdb::BackupEngineReadOnlyBase& engine);
[[nodiscard]] std::vector<Backup> backups_of(const rocksdb::BackupEngineReadOnlyBase& engine);

} // namespace scanloom::store
