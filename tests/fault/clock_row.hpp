#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// The wall clocks of the server and of a robot jump by a year, either way, while scans are sent. Nothing may depend on
/// them but stamps shown to people: no deadline passes early, the stream completes, the maps are those of a run in
/// peace. Needs Debian's faketime. Counts jumps.
[[nodiscard]] Outcome run_clock_row(const Run& run);

} // namespace scanloom::fault
