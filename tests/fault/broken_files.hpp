#pragma once

#include <rocksdb/env.h>

#include <memory>

namespace scanloom::fault {

/// RocksDB's file layer with syncs that say they are done, and do nothing.
[[nodiscard]] std::unique_ptr<rocksdb::Env> unsynced_files();

/// RocksDB's file layer with syncs that are tried, and called done when they have failed.
[[nodiscard]] std::unique_ptr<rocksdb::Env> trusting_files();

} // namespace scanloom::fault
