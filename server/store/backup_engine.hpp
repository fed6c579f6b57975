#pragma once

#include "server/store/backups.hpp"

#include <rocksdb/utilities/backup_engine.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace scanloom::store {

/// RocksDB's backup engine with Scanloom's options and metadata.

[[nodiscard]] rocksdb::BackupEngineOptions engine_options(const std::filesystem::path& directory);

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

} // namespace scanloom::store
