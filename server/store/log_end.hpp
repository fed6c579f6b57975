#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <rocksdb/db.h>

#include <string>

namespace scanloom::store {

/// The revision of a session's last entry, found by its key alone; 0 for an empty log.
/// @param store  its name, for the message.
/// Errors  kDataLoss: the place cannot be read.
[[nodiscard]] Result<Revision> end_of_log(rocksdb::DB& database, const std::string& store, SessionId session);

} // namespace scanloom::store
