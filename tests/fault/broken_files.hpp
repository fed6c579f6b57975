#pragma once

#include <rocksdb/env.h>

#include <memory>

namespace scanloom::fault {

/// RocksDB's file layer with syncs that report success and do nothing.
[[nodiscard]] std::unique_ptr<rocksdb::Env> unsynced_files();

/// RocksDB's file layer with syncs that report success even if they fail.
[[nodiscard]] std::unique_ptr<rocksdb::Env> trusting_files();

} // namespace scanloom::fault
