#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace scanloom::store {

/// A store that no server has open, as it lies on the disk.
struct AtRest {
    std::unique_ptr<ScanLog> log;          ///< to be read: every change fails
    std::uint64_t unfinished_bytes = 0;    ///< of a write that a crash cut short, which the next start drops: no damage
    std::vector<SessionId> without_record; ///< of which there are entries or parts alone
};

/// Opens a store to look at it, and changes not a byte of it; not even a lock or a line of a log is left behind. Reads
/// manifest and write-ahead log as a start does.
///
/// Errors  kNotFound: there is none; kConflict: a server has it open; kStoreFailed: it cannot be read, or is damaged
///         so that a start would refuse it, too; kUnsupportedVersion.
[[nodiscard]] Result<AtRest> open_at_rest(const std::filesystem::path& directory, const StoreOptions& options = {});

} // namespace scanloom::store
