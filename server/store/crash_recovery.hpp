#pragma once

#include "common/error/error.hpp"
#include "server/store/directory.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace scanloom::store {

/// A write at the end of RocksDB's newest write-ahead log that a crash cut short. It was never acknowledged.
struct UnfinishedWrite {
    std::filesystem::path file;
    std::uint64_t whole_bytes = 0; ///< size of the writes before it
    std::uint64_t bytes = 0;       ///< size of the rest, to be cut off
};

/// Checks that the manifest named by CURRENT is complete. RocksDB takes a damaged length near the end of the manifest
/// for its end and would ignore the rest.
/// Errors: kStoreFailed, naming file and offset.
[[nodiscard]] Result<> check_manifest(const std::filesystem::path& directory);

/// Checks that the newest write-ahead log exists, as far as file names and sizes show it. Succeeds if there is no log
/// at all, which LockedDirectory reports. A start creates a log and then the manifest with the next number; an empty
/// log that is older than that one is not the newest.
/// Errors: kStoreFailed: the newest log is missing.
[[nodiscard]] Result<> check_newest_log(const std::filesystem::path& directory);

/// Finds the write that a crash left unfinished; changes nothing.
/// Pre: every write was synced before the next one (Committer); RocksDB is not open.
/// @return nullopt if there is none
/// Errors: kStoreFailed, naming file and offset: damage in the write-ahead log or in the manifest.
[[nodiscard]] Result<std::optional<UnfinishedWrite>> find_unfinished_write(const LockedDirectory& directory);

/// Cuts off the write that a crash left unfinished at the end of RocksDB's write-ahead log, and syncs the file. The
/// rest must be intact, so that RocksDB can open it with kAbsoluteConsistency, which reports missing or damaged parts
/// instead of continuing without them.
///
/// Pre: every write was synced before the next one (Committer); RocksDB is not open.
/// Errors: kStoreFailed, naming file and offset: damage in the write-ahead log or in the manifest; nothing is changed.
/// @return number of bytes cut off; they were never acknowledged
[[nodiscard]] Result<std::uint64_t> cut_off_unfinished_write(const LockedDirectory& directory);

} // namespace scanloom::store
