#pragma once

#include "common/error/error.hpp"
#include "server/store/directory.hpp"

#include <cstdint>

namespace scanloom::store {

/// Cuts off the write that a crash left unfinished at the end of RocksDB's write-ahead log, and
/// makes that durable. What remains must be perfect, so that RocksDB can open it with
/// kAbsoluteConsistency, which reports whatever is missing or damaged instead of going on without it.
///
/// Pre     every write was synced before the next one (Committer); RocksDB is not open.
/// Errors  kStoreFailed, naming file and offset: damage in the write-ahead log or in the manifest;
///         nothing is changed.
/// @return bytes cut off; they were never acknowledged.
[[nodiscard]] Result<std::uint64_t> mend_after_crash(const LockedDirectory& directory);

} // namespace scanloom::store
