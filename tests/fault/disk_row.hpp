#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "disk": fills a small disk Run::count times while robots stream. Acknowledgements stop, /readyz reports the
/// reason, maps are still served, and the server resumes by itself when there is space again.
[[nodiscard]] Outcome run_disk_row(const Run& run);

} // namespace scanloom::fault
