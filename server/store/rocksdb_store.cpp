#include "server/store/rocksdb_store.hpp"

#include "server/store/database.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/rocksdb_scan_log.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <rocksdb/sst_file_reader.h>

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

Result<> check_table(const fs::path& table, const StoreOptions& options) {
    rocksdb::SstFileReader reader(options_of_table(options));
    auto status = reader.Open(table.native());
    if (status.ok()) status = reader.VerifyChecksum();
    if (status.ok()) return {};
    return Error{Errc::kDataLoss, fmt::format("{} is damaged ({}); {}", table.native(), status.ToString(), kRecover)};
}

} // namespace scanloom::store
