#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/session_captures.hpp"
#include "server/store/scan_log.hpp"

#include <functional>

namespace scanloom::session {

/// A capture that has ended. An error ends the reading.
using VisitCapture = std::function<Result<>(const landmarks::RobotCapture&)>;

/// Asked now and then, as a long log takes seconds; an error ends the reading.
using AskWhetherToGoOn = std::function<Result<>(Revision read)>;

/// Cuts captures from a session's log, from where `captures` stands up to `until`, and goes on from there another time.
/// Most scans of a robot that drives are only looked at for where they were taken.
/// Errors  those of the two; kDataLoss: an entry is damaged; those of ScanLog::read(). What was read until then is in.
/// Thread  any that may wait for the disk.
[[nodiscard]] Result<> read_captures(store::ScanLog& log, store::SessionId session,
                                     landmarks::SessionCaptures& captures, Revision until, const VisitCapture& visit,
                                     const AskWhetherToGoOn& ask);

} // namespace scanloom::session
