#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <rocksdb/db.h>

#include <string>

namespace scanloom::store {

/// Returns the revision of a session's last entry, 0 for an empty log. Reads only its key.
/// @param store  name of the store, for messages
/// Errors: kDataLoss: that part of the database cannot be read.
[[nodiscard]] Result<Revision> end_of_log(rocksdb::DB& database, const std::string& store, SessionId session);

} // namespace scanloom::store
