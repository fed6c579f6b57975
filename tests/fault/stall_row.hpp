#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "stall": the disk blocks all writes for seconds and then completes them. Needs root and loop devices.
[[nodiscard]] Outcome run_stall_row(const Run& run);

} // namespace scanloom::fault
