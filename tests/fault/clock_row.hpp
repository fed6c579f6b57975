#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "clock": the wall clocks of the server and of a robot jump by a year in either direction while scans are sent.
/// Only time stamps for display may depend on them: no deadline passes early, the stream completes, and the maps equal
/// those of an undisturbed run. Needs Debian's faketime. Counts jumps.
[[nodiscard]] Outcome run_clock_row(const Run& run);

} // namespace scanloom::fault
