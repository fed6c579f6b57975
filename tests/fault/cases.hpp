#pragma once

#include "tests/fault/row.hpp"

#include <cstdint>
#include <functional>
#include <string_view>

namespace scanloom::fault {

/// How a row's run is made of cases, each of a seed of its own: that of the run, and the following ones.
struct Cases {
    std::string_view row;
    std::uint64_t of_count = 1; ///< how much of Run::count one case is; the last one may be less
    std::size_t at_once = 1;    ///< on so many threads
    /// One case: its seed, and its part of the count.
    std::function<Outcome(std::uint64_t seed, std::uint64_t count)> run;
};

/// Runs cases until the count is reached, or some have failed: those that have say which command repeats just them.
/// What a case throws is what is amiss with it.
[[nodiscard]] Outcome run_cases(const Run& run, const Cases& cases);

} // namespace scanloom::fault
