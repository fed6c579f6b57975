#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "stall": the disk takes nothing for seconds, and then all that waited. Needs root and loop devices.
[[nodiscard]] Outcome run_stall_row(const Run& run);

} // namespace scanloom::fault
