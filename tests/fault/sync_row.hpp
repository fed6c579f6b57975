#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "sync": a server of which each sync of a file fails with one chance in five, until Run::count scans of four
/// robots are acknowledged: the store is opened again after a failure, by itself, and nothing that failed is trusted.
[[nodiscard]] Outcome run_sync_row(const Run& run);

} // namespace scanloom::fault
