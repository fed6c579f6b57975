#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "simulation": one story per seed, see simulation/story.hpp.
[[nodiscard]] Outcome run_simulation_row(const Run& run);

} // namespace scanloom::fault
