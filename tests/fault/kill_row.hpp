#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "kill": kill -9 at random points while robots stream: after a number of scans, after a time, while the server
/// starts and recovers, and while it stops and writes its last checkpoints. Counts kills.
[[nodiscard]] Outcome run_kill_row(const Run& run);

} // namespace scanloom::fault
