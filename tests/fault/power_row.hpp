#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "power": the disk below the store loses power while robots stream. Data that was not synced is lost; the server
/// is killed, the disk mounted again and the server restarted. Needs root and loop devices. Counts power cuts.
[[nodiscard]] Outcome run_power_row(const Run& run);

} // namespace scanloom::fault
