#pragma once

#include "server/store/compaction.hpp"
#include "server/store/rocksdb_store.hpp"

#include <rocksdb/options.h>

#include <memory>

namespace scanloom::store {

/// Returns the options for RocksDB; each choice is explained where it is made.
[[nodiscard]] rocksdb::Options rocksdb_options(const StoreOptions& options, std::shared_ptr<CompactionWatch> watch);

/// Returns the options for reading one table file by itself, without a cache.
[[nodiscard]] rocksdb::Options options_of_table(const StoreOptions& options);

} // namespace scanloom::store
