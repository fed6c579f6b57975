#pragma once

#include "server/store/compaction_watch.hpp"
#include "server/store/scan_log.hpp"

#include <rocksdb/options.h>

#include <memory>

namespace scanloom::store {

/// How RocksDB is run; each choice is explained where it is made.
[[nodiscard]] rocksdb::Options rocksdb_options(const StoreOptions& options, std::shared_ptr<CompactionWatch> watch);

/// For a table file that is read by itself.
[[nodiscard]] rocksdb::Options options_of_table(const StoreOptions& options);

} // namespace scanloom::store
