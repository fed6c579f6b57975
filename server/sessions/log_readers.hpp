#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan_filter.hpp"
#include "core/landmarks/captures.hpp"
#include "core/mapping/scan_poses.hpp"
#include "server/store/scan_log.hpp"

#include <functional>
#include <optional>

namespace scanloom::sessions {

/// Called before each entry with its revision and, if it is a scan, the scan's pose. False ends the reading before it.
using KeepReading = std::function<bool(Revision, const std::optional<ScanPose>&)>;

/// Reads all exclusions of a session's log, from its start until `keep_reading` returns false, or to its end.
///
/// Cost: about two seconds per million scans, whose ranges are not decoded.
/// Errors: kDataLoss or kMalformed if an entry is damaged; those of ScanLog::read().
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<Exclusions> read_exclusions(store::ScanLog& log, store::SessionId session,
                                                 const KeepReading& keep_reading);

/// Called for each capture that is complete. An error ends the reading.
using VisitCapture = std::function<Result<>(const landmarks::RobotCapture&)>;

/// Called from time to time with the last revision read, because a long log takes seconds. An error ends the reading.
using CheckContinue = std::function<Result<>(Revision read)>;

/// Reads the captures of a session's log from captures.revision() up to `until`. A later call continues there.
///
/// Of most scans of a moving robot, only the pose is decoded.
/// @param captures  advanced by each entry read, also if the reading ends with an error
/// @param poses  of the scans that robots sent without; the same in later calls
/// Errors: those of `visit` and `ask`; kDataLoss if an entry is damaged; those of ScanLog::read().
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<> read_captures(store::ScanLog& log, store::SessionId session,
                                     landmarks::SessionCaptures& captures, Revision until,
                                     const mapping::ScanPoses& poses, const VisitCapture& visit,
                                     const CheckContinue& ask);

} // namespace scanloom::sessions
