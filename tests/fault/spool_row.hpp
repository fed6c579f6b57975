#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// The network is away while a lidar turns, and the robot's program is killed while it sends what its spool holds, at
/// another moment each time, or before the network comes back. Counts kills.
[[nodiscard]] Outcome run_spool_row(const Run& run);

} // namespace scanloom::fault
