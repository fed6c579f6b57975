#pragma once

#include "common/error/error.hpp"
#include "server/store/rocksdb_scan_log.hpp"

#include <rocksdb/db.h>

#include <filesystem>

/// What a database must tell of itself before it is a scan log. `directory` is for the messages.
namespace scanloom::store {

/// Why RocksDB does not open it.
[[nodiscard]] Error cannot_open(const std::filesystem::path& directory, const rocksdb::Status& status);

/// Whether the format record has to be written: the database is empty, or of an earlier format.
/// Errors  kUnsupportedVersion: of a newer one; kStoreFailed: another program's, or damaged.
[[nodiscard]] Result<bool> must_write_format(rocksdb::DB& database, const std::filesystem::path& directory);

/// Errors  kStoreFailed: what is needed to number sessions is damaged. Damage of one session is in the answer.
[[nodiscard]] Result<LogEnds> read_ends(rocksdb::DB& database, const std::filesystem::path& directory);

} // namespace scanloom::store
