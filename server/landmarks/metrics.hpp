#pragma once

#include "server/landmarks/matching.hpp"

#include <optional>
#include <span>

namespace scanloom::landmarks {

/// How alike two sets of landmarks are. What would be divided by none is nothing.
struct Metrics {
    std::size_t matched = 0;
    std::optional<double> persistence;   ///< matched of the first set's landmarks
    std::optional<double> stability;     ///< of the matched, those at most half the tolerance apart
    std::optional<double> distance_mean; ///< metres, of the matched
    std::optional<double>
        distance_sigma; ///< metres, their standard deviation: of these pairs, so divided by their number
};

/// @param matches      what match() found with `tolerance`
/// @param first_count  landmarks of the first set
/// Pre     no more matches than first_count.
[[nodiscard]] Metrics metrics_of(std::span<const Match> matches, std::size_t first_count,
                                 double tolerance = kTolerance);

} // namespace scanloom::landmarks
