#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// The server is stopped, or killed, and started again while a hundred robots stream. Counts restarts.
[[nodiscard]] Outcome run_restart_row(const Run& run);

} // namespace scanloom::fault
