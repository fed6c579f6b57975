#pragma once

#include "common/error/error.hpp"
#include "common/scan/exclusions.hpp"
#include "server/store/scan_log.hpp"

#include <functional>
#include <optional>

namespace scanloom::session {

/// Called before each entry with its revision and, if it is a scan, the scan's pose. False ends the reading before it.
using ReadsOn = std::function<bool(Revision, const std::optional<ScanPose>&)>;

/// Reads all exclusions of a session's log, from its start until `reads_on` returns false, or to its end.
///
/// Cost: about two seconds per million scans, whose ranges are not decoded.
/// Errors: kDataLoss or kMalformed if an entry is damaged; those of ScanLog::read().
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<Exclusions> read_exclusions(store::ScanLog& log, store::SessionId session,
                                                 const ReadsOn& reads_on);

} // namespace scanloom::session
