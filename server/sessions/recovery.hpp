#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "core/localization/localized_projection.hpp"
#include "core/mapping/projection.hpp"
#include "server/store/scan_log.hpp"

#include <fmt/format.h>

#include <atomic>
#include <optional>

namespace scanloom::sessions {

/// Returns the error (kDataLoss) for a log entry that has a correct checksum but cannot be decoded.
[[nodiscard]] inline Error damaged_entry(Revision revision, const Error& why) {
    return {Errc::kDataLoss, fmt::format("log entry {}: {}", revision, why.message)};
}

/// The maps of a session that were recovered from the store.
struct Recovered {
    localization::LocalizedProjection maps;
    /// Revision of the checkpoint that it started from; 0 if there was none. Nullopt if the stored checkpoint cannot be
    /// used or has the format of an earlier version; the next checkpoint must replace it.
    std::optional<Revision> checkpointed{};
    std::optional<Error> checkpoint_rejected{}; ///< why the whole log was replayed instead
    bool complete = true;                       ///< false: `stop` became true before the end of the log
};

/// Recovers a session from its newest checkpoint and the rest of its log. Replays the whole log if the checkpoint
/// cannot be used or if the rest of the log excludes scans that are in it. Shows the poses as corrected last if the log
/// has announced that; otherwise the maps are outdated.
///
/// @param stop  checked from time to time
/// Errors: kDataLoss or kMalformed if the log is damaged, with the entry in the message; kStoreFailed; kOverloaded if
/// memory ran out.
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<Recovered> recover(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                                        const std::atomic<bool>& stop);

} // namespace scanloom::sessions
