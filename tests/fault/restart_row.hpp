#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "restart": stops or kills the server and starts it again while a hundred robots stream. Counts restarts.
[[nodiscard]] Outcome run_restart_row(const Run& run);

} // namespace scanloom::fault
