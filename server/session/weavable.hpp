#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "server/mapping/projection.hpp"

namespace scanloom::session {

/// Whether a session with the projection's settings would have taken this entry of another session's log. Robots are
/// told when they send it; whoever weaves it once more is told here, by the robot's and the sensor's names.
/// Pre     the projection holds the entries before it. One that cannot follow them passes: folding tells.
/// Errors  kInvalidField: the cells are too small for it.
[[nodiscard]] Result<> check_weavable(const mapping::Projection& projection, const LogEntry& entry);

} // namespace scanloom::session
