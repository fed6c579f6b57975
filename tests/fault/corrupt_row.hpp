#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "corrupt": damages a store of known contents and opens it with a server. Either the server reports the damage
/// (it refuses to start, logs it, or answers with an error in place of the session), or the served data equals the
/// stored data. Counts damaged stores, each with its own seed.
///
/// One kind of damage is indistinguishable from a crash: a newest log file that ends early, at the end of a write or
/// within one, is what a crash leaves of writes that were never acknowledged. The session may then be served without
/// its last scans; such sessions are counted as "shortened".
[[nodiscard]] Outcome run_corrupt_row(const Run& run);

} // namespace scanloom::fault
