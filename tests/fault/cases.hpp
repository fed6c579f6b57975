#pragma once

#include "tests/fault/row.hpp"

#include <cstdint>
#include <functional>
#include <string_view>

namespace scanloom::fault {

/// Divides a row's run into cases. Their seeds are the run's seed and those that follow it.
struct Cases {
    std::string_view row;
    std::uint64_t of_count = 1; ///< part of Run::count that one case covers; less for the last case
    std::size_t at_once = 1;    ///< number of threads
    /// Runs one case with its seed and its part of the count.
    std::function<Outcome(std::uint64_t seed, std::uint64_t count)> run;
};

/// Runs cases until the count is reached or some have failed. For a failed case, reports the command that repeats only
/// that case. An exception that a case throws is reported as its failure.
[[nodiscard]] Outcome run_cases(const Run& run, const Cases& cases);

} // namespace scanloom::fault
