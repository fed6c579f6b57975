#pragma once

#include "tests/fault/outcome.hpp"

#include <optional>
#include <vector>

namespace scanloom::fault {

/// How soon robots were acknowledged: p99 in milliseconds, a figure of each round; nothing where a round does not tell.
struct Paces {
    using Figures = std::vector<std::optional<double>>;

    Figures alone{}; ///< while the machine has nothing else to do; empty: that was not tried
    Figures in_peace{};
    Figures beside{}; ///< the crowd
};

/// Tells the medians, in microseconds: "p99_alone_us", "p99_in_peace_us", "p99_beside_us". Of an even number of rounds,
/// the upper one.
/// Amiss   a figure is missing; or they must keep up, and waited more than twice as long beside the crowd as in peace.
void check_paces(const Paces& paces, bool must_keep_up, Outcome& outcome);

} // namespace scanloom::fault
