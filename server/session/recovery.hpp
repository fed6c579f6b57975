#pragma once

#include "common/error/error.hpp"
#include "server/mapping/projection.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <optional>

namespace scanloom::session {

/// A session woven again, up to the end of its log.
struct Recovered {
    mapping::Projection projection;
    /// Revision of the checkpoint it began from, 0 if there was none; nothing if there is one that cannot be used, or
    /// that an earlier version wrote in another format: the next one takes its place.
    std::optional<Revision> checkpointed{};
    std::optional<Error> checkpoint_rejected{}; ///< why the whole log was folded instead
    bool complete = true;                       ///< false: `stop` became true before the log's end
};

/// Newest checkpoint, then the rest of the log; the whole log where the checkpoint cannot be used, or where the rest
/// excludes scans that are in it.
/// Errors  kDataLoss, kMalformed: the log is damaged; the message names the entry. kStoreFailed.
///         kOverloaded: memory ran out.
[[nodiscard]] Result<Recovered> recover(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                                        const std::atomic<bool>& stop);

} // namespace scanloom::session
