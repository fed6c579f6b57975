#pragma once

#include "tests/fault/row.hpp"

namespace scanloom::fault {

/// Row "soak": many scans of the same places. The server's memory must not grow after a warm-up.
[[nodiscard]] Outcome run_soak_row(const Run& run);

constexpr std::uint64_t kSoakLong = 20'000'000;

} // namespace scanloom::fault
