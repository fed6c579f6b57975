#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// kill -9 at random points while robots stream: after so many scans, after so much time, while the server starts and
/// recovers, and while it stops and writes its last checkpoints. Counts kills.
[[nodiscard]] Outcome run_kill_row(const Run& run);

} // namespace scanloom::fault
