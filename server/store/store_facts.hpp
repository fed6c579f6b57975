#pragma once

#include "common/error/error.hpp"
#include "server/store/rocksdb_scan_log.hpp"

#include <rocksdb/db.h>

#include <filesystem>

/// Checks of a database before it becomes a scan log. `directory` is for messages.
namespace scanloom::store {

/// Whether the format record has to be written: the database is empty or of an earlier format.
/// Errors: kUnsupportedVersion: it is of a newer format; kStoreFailed: it belongs to another program or is damaged.
[[nodiscard]] Result<bool> must_write_format(rocksdb::DB& database, const std::filesystem::path& directory);

/// Reads the end of each session's log and the id of the next session. Damage of one session is part of the result.
/// Errors: kStoreFailed: the record that numbers sessions is damaged.
[[nodiscard]] Result<LogEnds> read_ends(rocksdb::DB& database, const std::filesystem::path& directory);

} // namespace scanloom::store
