#pragma once

#include "server/store/scan_log.hpp"

#include <rocksdb/options.h>

namespace scanloom::store {

/// How RocksDB is run; each choice is explained where it is made.
[[nodiscard]] rocksdb::Options rocksdb_options(const StoreOptions& options);

} // namespace scanloom::store
