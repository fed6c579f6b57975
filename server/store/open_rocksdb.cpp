#include "server/store/compaction.hpp"
#include "server/store/crash_recovery.hpp"
#include "server/store/record.hpp"
#include "server/store/rocksdb_options.hpp"
#include "server/store/rocksdb_scan_log.hpp"
#include "server/store/store_error.hpp"
#include "server/store/store_facts.hpp"
#include "server/store/unfinished_store.hpp"

#include <memory>
#include <string>
#include <utility>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

Result<> write_format(rocksdb::DB& database, const fs::path& directory) {
    rocksdb::WriteOptions options;
    options.sync = true;
    const std::string key(kFormatKey);
    const auto status = database.Put(options, key, sealed(key, number_bytes(kFormatVersion)));
    if (!status.ok()) return cannot_open(directory, status);
    return {};
}

Result<std::unique_ptr<ScanLog>> open_locked(Result<LockedDirectory> locked, const StoreOptions& options) {
    if (!locked) return locked.error();
    const auto& directory = locked->path();
    const auto dropped = mend_after_crash(*locked);
    if (!dropped) return dropped.error();

    const auto watch = std::make_shared<CompactionWatch>();
    rocksdb::DB* opened = nullptr;
    const auto status = rocksdb::DB::Open(rocksdb_options(options, watch), directory.native(), &opened);
    std::unique_ptr<rocksdb::DB> database(opened);
    if (!status.ok()) return cannot_open(directory, status);

    const auto must_write = must_write_format(*database, directory);
    if (!must_write) return must_write.error();
    if (*must_write) {
        if (auto written = write_format(*database, directory); !written) return written.error();
    }
    if (auto finished = locked->finish_creation(); !finished) return finished.error();
    auto ends = read_ends(*database, directory);
    if (!ends) return ends.error();
    auto files = std::make_unique<FilesWatch>(*database, directory);
    return std::make_unique<RocksdbScanLog>(std::move(*locked), std::move(database), std::move(*ends), *dropped, watch,
                                            std::move(files), options);
}

} // namespace

Result<std::unique_ptr<ScanLog>> open_rocksdb(const fs::path& directory, const StoreOptions& options) {
    return open_locked(LockedDirectory::open(directory), options);
}

Result<std::unique_ptr<ScanLog>> UnfinishedStore::open_log() const {
    StoreOptions options;
    options.disk_reserve_bytes = 0; // no other writer: the store either fits or does not
    return open_locked(LockedDirectory::open(directory_, LockedDirectory::Files::kUnfinished), options);
}

} // namespace scanloom::store
