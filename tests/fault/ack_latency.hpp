#pragma once

#include "tests/fault/outcome.hpp"

#include <optional>
#include <vector>

namespace scanloom::fault {

/// The acknowledgement latency of robots: p99 in milliseconds for each round; nullopt if a round does not report it.
struct AckLatency {
    using Figures = std::vector<std::optional<double>>;

    Figures alone{}; ///< while the machine is otherwise idle; empty: not measured
    Figures baseline{};
    Figures with_crowd{}; ///< with the crowd
};

/// Reports the medians in microseconds: "p99_alone_us", "p99_baseline_us", "p99_with_crowd_us". For an even number of
/// rounds, the upper one.
/// Fails if a figure is missing, or if robots must keep up and the latency with the crowd was more than twice that
/// without.
void check_latency(const AckLatency& latency, bool must_keep_up, Outcome& outcome);

} // namespace scanloom::fault
