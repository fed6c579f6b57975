#include "tests/fault/ack_latency.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::fault {
namespace {

/// Returns nullopt if a value is missing, as the median of the others would be that of a different run.
std::optional<double> median(AckLatency::Figures figures) {
    if (figures.empty() || !std::ranges::all_of(figures, [](const auto& figure) { return figure.has_value(); })) {
        return std::nullopt;
    }
    std::ranges::sort(figures);
    return figures[figures.size() / 2];
}

void report(const char* name, std::optional<double> milliseconds, Outcome& outcome) {
    if (milliseconds) outcome.figures[name] = static_cast<std::uint64_t>(std::llround(*milliseconds * 1e3));
}

} // namespace

void check_latency(const AckLatency& latency, bool must_keep_up, Outcome& outcome) {
    const auto alone = median(latency.alone);
    const auto baseline = median(latency.baseline);
    const auto with_crowd = median(latency.with_crowd);
    report("p99_alone_us", alone, outcome);
    report("p99_baseline_us", baseline, outcome);
    report("p99_with_crowd_us", with_crowd, outcome);
    if (!baseline || !with_crowd || (!alone && !latency.alone.empty())) {
        outcome.failures.emplace_back("a round did not report the latency of its acknowledgements");
        return;
    }
    if (!must_keep_up || *with_crowd <= 2.0 * *baseline) return;
    outcome.failures.push_back(fmt::format("acknowledgements took {:.1f} ms (p99) with the crowd, {:.1f} ms without it",
                                           *with_crowd, *baseline));
}

} // namespace scanloom::fault
