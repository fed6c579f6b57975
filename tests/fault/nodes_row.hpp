#pragma once

#include "tests/fault/outcome.hpp"
#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Three servers that share a database: each in turn is killed, stopped, paused for longer than it counts as alive, or
/// dead for as long; or the database is killed and started again. Robots stream meanwhile, and find their sessions.
[[nodiscard]] Outcome run_nodes_row(const Run& run);

} // namespace scanloom::fault
