#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "server/mapping/projection.hpp"

namespace scanloom::session {

/// Checks whether a session with the projection's settings would have accepted a log entry. Links check this when a
/// robot sends the entry; this function checks it for replay jobs, whose settings may differ. Its errors name the robot
/// and the sensor.
///
/// Does not check whether the entry can follow the earlier ones; Projection::fold() does.
/// @param projection  contains the entries before it
/// Errors: kInvalidField if the cells are too small for the range of the sensor or the size of the scan or map.
[[nodiscard]] Result<> check_weavable(const mapping::Projection& projection, const LogEntry& entry);

} // namespace scanloom::session
