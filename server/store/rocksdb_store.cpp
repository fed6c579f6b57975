#include "server/store/rocksdb_store.hpp"

#include "server/store/database.hpp"
#include "server/store/rocksdb_scan_log.hpp"

#include <utility>

namespace scanloom::store {
namespace fs = std::filesystem;

Result<std::unique_ptr<ScanLog>> open_rocksdb(const fs::path& directory, const StoreOptions& options) {
    return RocksdbScanLog::open(directory, LockedDirectory::Files::kComplete, options);
}

Result<ReadOnlyStore> open_read_only(const fs::path& directory, const StoreOptions& options) {
    auto database = Database::open_read_only(directory, options);
    if (!database) return database.error();
    ReadOnlyStore store;
    store.unfinished_bytes = (*database)->stats().torn_bytes_dropped;
    store.without_record = (*database)->owners_without_record();
    store.log = std::make_unique<RocksdbScanLog>(std::move(*database), options);
    return store;
}

} // namespace scanloom::store
