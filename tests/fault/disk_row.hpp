#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "disk": Run::count fillings of a small disk under streaming robots: acknowledgements stop, /readyz says why,
/// maps are served, and all goes on by itself when there is room again.
[[nodiscard]] Outcome run_disk_row(const Run& run);

} // namespace scanloom::fault
