#include "server/landmarks/metrics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanloom::landmarks {

Metrics metrics_of(std::span<const Match> matches, std::size_t first_count, double tolerance) {
    assert(matches.size() <= first_count);
    Metrics metrics{.matched = matches.size()};
    const auto count = static_cast<double>(matches.size());
    if (first_count > 0) metrics.persistence = count / static_cast<double>(first_count);
    if (matches.empty()) return metrics;
    const auto close = std::ranges::count_if(
        matches, [&](double d) { return d <= tolerance / 2.0; }, &Match::distance);
    metrics.stability = static_cast<double>(close) / count;
    double sum = 0.0;
    for (const Match& match : matches) sum += match.distance;
    const double mean = sum / count;
    double squares = 0.0;
    for (const Match& match : matches) squares += (match.distance - mean) * (match.distance - mean);
    metrics.distance_mean = mean;
    metrics.distance_sigma = std::sqrt(squares / count);
    return metrics;
}

} // namespace scanloom::landmarks
