#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// The disk below the store loses its power while robots stream: what was not synced is gone, the server is killed, the
/// disk mounted again and the server started. Needs root and loop devices. Counts cuts.
[[nodiscard]] Outcome run_power_row(const Run& run);

} // namespace scanloom::fault
