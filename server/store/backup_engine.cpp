#include "server/store/backup_engine.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace scanloom::store {

rocksdb::BackupEngineOptions engine_options(const std::filesystem::path& directory) {
    rocksdb::BackupEngineOptions options(directory.native());
    options.sync = true;
    options.share_table_files = true;
    options.share_files_with_checksum = true; // tables of two stores may have the same name
    options.backup_rate_limit = Backups::kBytesPerSecond;
    return options;
}

BackupMetadata metadata_of(const rocksdb::BackupInfo& info) {
    BackupMetadata metadata;
    const auto& text = info.app_metadata;
    const auto [end, unread] = std::from_chars(text.data(), text.data() + text.size(), metadata.sessions);
    if (unread == std::errc{} && end != text.data() + text.size()) metadata.store = std::string(end + 1);
    return metadata;
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

} // namespace scanloom::store
