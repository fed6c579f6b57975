#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "sync": each sync of a file on the server fails with a probability of one in five, until Run::count scans of
/// four robots are acknowledged. After a failure the server must reopen the store itself and must not rely on data
/// whose sync failed.
[[nodiscard]] Outcome run_sync_row(const Run& run);

} // namespace scanloom::fault
