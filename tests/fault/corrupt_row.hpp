#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// A store of known contents is damaged and opened by a server. The damage is found and told (the server refuses to
/// start, or logs it, or answers with an error in place of the session) or shows nowhere: what is served is what was
/// stored. Counts damaged stores, each of a seed of its own.
///
/// One kind of damage looks as if nothing had happened to anybody: a newest log file that ends early, at the end of a
/// write or within one, is what a crash leaves of writes that were never acknowledged. Then a session may be served
/// with fewer scans, those at its end missing; these are counted as "shortened".
[[nodiscard]] Outcome run_corrupt_row(const Run& run);

} // namespace scanloom::fault
