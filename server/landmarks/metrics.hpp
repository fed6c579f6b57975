#pragma once

#include "server/landmarks/matching.hpp"

#include <optional>
#include <span>

namespace scanloom::landmarks {

/// How consistent two sets of landmarks are. A value is nullopt if it would be divided by 0.
struct Metrics {
    std::size_t matched = 0;
    std::optional<double> persistence;   ///< fraction of the first set's landmarks that are matched
    std::optional<double> stability;     ///< fraction of the matches at most half the tolerance apart
    std::optional<double> distance_mean; ///< metres, of the matches
    std::optional<double>
        distance_sigma; ///< metres, standard deviation of the matches' distances, divided by their number
};

/// Computes how consistent two sets of landmarks are.
/// @param matches      the result of match() with `tolerance`
/// @param first_count  number of landmarks of the first set
/// @param tolerance    metres
/// Precondition: there are no more matches than first_count.
[[nodiscard]] Metrics metrics_of(std::span<const Match> matches, std::size_t first_count,
                                 double tolerance = kTolerance);

} // namespace scanloom::landmarks
