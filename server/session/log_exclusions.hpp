#pragma once

#include "common/error/error.hpp"
#include "common/scan/exclusions.hpp"
#include "server/store/scan_log.hpp"

#include <functional>
#include <optional>

namespace scanloom::session {

/// Asked before each entry is read, with its scan, if it is one: false ends the reading before it.
using ReadsOn = std::function<bool(Revision, const std::optional<ScanPose>&)>;

/// Reads all exclusions of a session's log, from its beginning to where `reads_on` ends it, or to its end. Ranges of
/// scans are not read: a million scans take about two seconds.
/// Errors  kDataLoss, kMalformed: an entry is damaged; those of ScanLog::read().
/// Thread  any that may wait for the disk.
[[nodiscard]] Result<Exclusions> read_exclusions(store::ScanLog& log, store::SessionId session,
                                                 const ReadsOn& reads_on);

} // namespace scanloom::session
