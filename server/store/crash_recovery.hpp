#pragma once

#include "common/error/error.hpp"
#include "server/store/directory.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace scanloom::store {

/// What a crash left of a write, at the end of RocksDB's newest write-ahead log: it was never acknowledged.
struct UnfinishedWrite {
    std::filesystem::path file;
    std::uint64_t whole_bytes = 0; ///< of the writes before it
    std::uint64_t bytes = 0;       ///< that are to be cut off
};

/// Whether the manifest that CURRENT names is whole: RocksDB takes a damaged length near its end for its end, and would
/// go on without the rest.
/// Errors  kStoreFailed, naming file and offset.
[[nodiscard]] Result<> check_manifest(const std::filesystem::path& directory);

/// Whether the newest write-ahead log is there, as far as that can be told; where there is none at all, a listing
/// tells. A start makes a log, then the manifest behind it: so one that is empty, and older than that, is not the
/// newest.
/// Errors  kStoreFailed.
[[nodiscard]] Result<> check_newest_log(const std::filesystem::path& directory);

/// Reads manifest and write-ahead log and changes nothing.
/// Pre, Errors  as of mend_after_crash().
[[nodiscard]] Result<std::optional<UnfinishedWrite>> find_unfinished_write(const LockedDirectory& directory);

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
