#include "server/store/rocksdb_options.hpp"

#include <rocksdb/cache.h>
#include <rocksdb/env.h>
#include <rocksdb/table.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>

namespace scanloom::store {
namespace {

/// Passes RocksDB's log lines of level WARN and above to a function.
///
/// RocksDB's own logger writes a file next to the tables, and aborts the process at the first line after one for which
/// the disk had no room.
///
/// Threads: any.
/// Source: RocksDB 7.8, logging/env_logger.h; WritableFileWriter::AssertFalseAndGetStatusForPrevError().
class RocksdbLog final : public rocksdb::Logger {
public:
    using Write = std::function<void(std::string_view line)>;

    /// @param write  called with each line, from threads of RocksDB; null: lines are dropped
    explicit RocksdbLog(Write write) : Logger(rocksdb::InfoLogLevel::WARN_LEVEL), write_(std::move(write)) {}

    using Logger::Logv;
    void Logv(rocksdb::InfoLogLevel level, const char* format, std::va_list arguments) override {
        if (level < GetInfoLogLevel() || !write_) return;
        std::array<char, kLineBytesMax> line{};
        std::vsnprintf(line.data(), line.size(), format, arguments);
        write_(line.data());
    }

    /// Drops the options that RocksDB lists when a store is opened.
    void LogHeader(const char*, std::va_list) override {}

private:
    static constexpr std::size_t kLineBytesMax = 1024; // longer lines are cut off

    const Write write_;
};

/// Sets the order in which changes become durable, and what recovery accepts.
void set_durability(rocksdb::Options& rocksdb) {
    rocksdb.create_if_missing = true; // LockedDirectory has already refused a store that lost its CURRENT
    rocksdb.paranoid_checks = true;
    // cut_off_unfinished_write() has cut off what a crash left unfinished; any other inconsistency is damage.
    rocksdb.wal_recovery_mode = rocksdb::WALRecoveryMode::kAbsoluteConsistency;
    rocksdb.track_and_verify_wals_in_manifest = true;  // detects a lost or shortened older write-ahead log
    rocksdb.recycle_log_file_num = 0;                  // stale records behind the end would look like later writes
    rocksdb.wal_compression = rocksdb::kNoCompression; // check_log_file() reads plain records only
    // Recovered entries are written to a synced table before they are read: after a failed fsync, the write-ahead log
    // may be complete in the system's cache only.
    rocksdb.avoid_flush_during_recovery = false;
    rocksdb.enable_pipelined_write = false; // the memtable is filled after the sync, see Committer
    rocksdb.unordered_write = false;
    rocksdb.write_dbid_to_manifest = true; // a backup has no file IDENTITY; a restored store keeps its identity
    rocksdb.max_bgerror_resume_count = 0;  // a failed store stays failed until it is opened again
}

/// One column family for everything, hence one memtable and one write-ahead log: after any flush, the disk holds a
/// prefix of the changes. Several families would need atomic_flush for that.
void set_memory(rocksdb::Options& rocksdb, const StoreOptions& options) {
    rocksdb.write_buffer_size = std::max<std::size_t>(options.memory_bytes / 8, 64 << 10);
    rocksdb.max_write_buffer_number = 4; // together with the cache: memory_bytes
    rocksdb.max_open_files = 256;        // the rest of the usual 1024 descriptors is for sockets
    rocksdb::BlockBasedTableOptions table;
    table.block_cache = rocksdb::NewLRUCache(options.memory_bytes / 2);
    table.cache_index_and_filter_blocks = true; // otherwise they would grow with the store, without a bound
    // A damaged block costs about six scans, and a damaged part of the index those of 160 blocks; see DamagedStore.
    table.block_size = 4 << 10;
    table.index_type = rocksdb::BlockBasedTableOptions::kTwoLevelIndexSearch;
    table.metadata_block_size = 4 << 10;
    table.max_auto_readahead_size = 0; // the system reads ahead; RocksDB's own asserts that no file is cut short
    rocksdb.table_factory.reset(rocksdb::NewBlockBasedTableFactory(table));
}

void set_disk(rocksdb::Options& rocksdb, const StoreOptions& options) {
    // Ranges of scans are packed and checkpoints compressed before they are stored. Compressing them again at each
    // merge took a fifth of the server's time.
    rocksdb.compression = rocksdb::kNoCompression;
    rocksdb.bottommost_compression = rocksdb::kNoCompression;
    rocksdb.level_compaction_dynamic_level_bytes = true;
    rocksdb.target_file_size_base = rocksdb.write_buffer_size;
    rocksdb.max_bytes_for_level_base = 4 * rocksdb.write_buffer_size;
    rocksdb.max_background_jobs = 2;
    rocksdb.table_properties_collector_factories.push_back(compaction_of_removals());
    // Writes slow down when merging cannot keep up, but never stop: merging may have ended for good, see
    // CompactionWatch.
    rocksdb.level0_stop_writes_trigger = std::numeric_limits<int>::max();
    rocksdb.hard_pending_compaction_bytes_limit = 0;
    rocksdb.bytes_per_sync = 1 << 20; // writes tables out steadily, not in one burst that delays the log's fsync
    if (options.env != nullptr) rocksdb.env = options.env;
}

void set_reports(rocksdb::Options& rocksdb, const StoreOptions& options) {
    rocksdb.info_log = std::make_shared<RocksdbLog>(options.on_log_line);
    rocksdb.stats_dump_period_sec = 0;
    rocksdb.stats_persist_period_sec = 0;
}

} // namespace

rocksdb::Options rocksdb_options(const StoreOptions& options, std::shared_ptr<CompactionWatch> watch) {
    rocksdb::Options rocksdb;
    set_durability(rocksdb);
    set_memory(rocksdb, options);
    set_disk(rocksdb, options);
    set_reports(rocksdb, options);
    rocksdb.listeners.push_back(std::move(watch));
    return rocksdb;
}

rocksdb::Options options_of_table(const StoreOptions& options) {
    rocksdb::BlockBasedTableOptions table;
    table.no_block_cache = true;
    table.max_auto_readahead_size = 0;
    rocksdb::Options rocksdb;
    rocksdb.table_factory.reset(rocksdb::NewBlockBasedTableFactory(table));
    if (options.env != nullptr) rocksdb.env = options.env;
    return rocksdb;
}

} // namespace scanloom::store
