#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace scanloom::store {

/// A store on disk that no server has open.
struct AtRest {
    std::unique_ptr<ScanLog> log;          ///< read-only: every change fails
    std::uint64_t unfinished_bytes = 0;    ///< of a write that a crash cut short; not damage: the next start drops it
    std::vector<SessionId> without_record; ///< sessions with entries or checkpoint parts but without a record
};

/// Opens a store for reading and changes no byte of it: neither a lock file nor a log line is left behind. Reads
/// manifest and write-ahead log as a start does.
///
/// Errors: kNotFound: there is no store; kConflict: a server has it open; kStoreFailed, kDataLoss: it cannot be read,
///         or is so damaged that a start would refuse it as well; kUnsupportedVersion: a newer program wrote it.
[[nodiscard]] Result<AtRest> open_at_rest(const std::filesystem::path& directory, const StoreOptions& options = {});

} // namespace scanloom::store
