#include "server/store/backup_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

/// Stored with each backup; backups of earlier versions lack `store`.
struct BackupMetadata {
    std::size_t sessions = 0;
    std::string store; ///< identity of the store; empty: unknown
};

BackupMetadata metadata_of(const rocksdb::BackupInfo& info) {
    BackupMetadata metadata;
    const auto& text = info.app_metadata;
    const auto [end, unread] = std::from_chars(text.data(), text.data() + text.size(), metadata.sessions);
    if (unread == std::errc{} && end != text.data() + text.size()) metadata.store = std::string(end + 1);
    return metadata;
}

} // namespace

rocksdb::BackupEngineOptions engine_options(const fs::path& directory) {
    rocksdb::BackupEngineOptions options(directory.native());
    options.sync = true;
    options.share_table_files = true;
    options.share_files_with_checksum = true; // tables of two stores may have the same name
    options.backup_rate_limit = Backups::kBytesPerSecond;
    return options;
}

Backup backup_of(const rocksdb::BackupInfo& info) {
    return {info.backup_id, static_cast<double>(info.timestamp), info.size, metadata_of(info).sessions};
}

std::vector<rocksdb::BackupInfo> infos_of(const rocksdb::BackupEngineReadOnlyBase& engine) {
    std::vector<rocksdb::BackupInfo> infos;
    engine.GetBackupInfo(&infos);
    std::ranges::sort(infos, {}, &rocksdb::BackupInfo::backup_id);
    return infos;
}

std::vector<Backup> backups_of(const rocksdb::BackupEngineReadOnlyBase& engine) {
    std::vector<Backup> found;
    for (const auto& info : infos_of(engine)) found.push_back(backup_of(info));
    return found;
}

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

Result<std::string> identity_of(rocksdb::DB& database) {
    std::string identity;
    if (const auto status = database.GetDbIdentity(identity); !status.ok()) {
        return failure("the identity of the store cannot be read: {}", status.ToString());
    }
    return identity;
}

Result<> back_up(rocksdb::DB& database, const fs::path& directory, std::size_t sessions, const std::stop_token& stop) {
    const auto identity = identity_of(database);
    if (!identity) return identity.error();
    const auto engine = open_engine<rocksdb::BackupEngine>(directory);
    if (!engine) return engine.error();
    if (auto owned = check_owner(**engine, directory, *identity); !owned) return owned;
    const std::stop_callback stopping(stop, [&engine] { (*engine)->StopBackup(); });
    rocksdb::BackupID id = 0;
    rocksdb::CreateBackupOptions options;
    options.flush_before_backup = true; // otherwise each backup would copy entries of the write-ahead log again
    const auto metadata = fmt::format("{} {}", sessions, *identity);
    auto status = (*engine)->CreateNewBackupWithMetadata(options, &database, metadata, &id);
    if (status.ok()) status = (*engine)->VerifyBackup(id, true);
    if (status.ok()) return {};
    if (id != 0) (*engine)->DeleteBackup(id).PermitUncheckedError();
    if (status.IsIncomplete()) return Error{Errc::kShuttingDown, "the server is shutting down: no backup was made"};
    return failure("no backup could be made in {}: {}", directory.native(), status.ToString());
}

} // namespace scanloom::store
