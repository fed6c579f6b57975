#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Run::count fillings of a small disk under streaming robots: acknowledgements stop, /readyz says why, maps are
/// served, and all goes on by itself when there is room again.
[[nodiscard]] Outcome run_disk_row(const Run& run);

/// A server of which each sync of a file fails with one chance in five, until Run::count scans of four robots are
/// acknowledged: the store is opened again after each failure, by itself.
[[nodiscard]] Outcome run_sync_row(const Run& run);

} // namespace scanloom::fault
