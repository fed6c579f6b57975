#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "spool": the network is down while a lidar turns, and the robot's program is killed while it sends the contents
/// of its spool, at a different moment each time, or before the network returns. Counts kills.
[[nodiscard]] Outcome run_spool_row(const Run& run);

} // namespace scanloom::fault
