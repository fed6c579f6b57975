#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr double kTolerance = 0.25; ///< metres

/// Points of two sets that are each other's nearest neighbours.
struct Match {
    std::size_t first;  ///< index in the first set
    std::size_t second; ///< index in the second set
    double distance;    ///< metres

    friend bool operator==(const Match&, const Match&) = default;
};

/// Finds mutual nearest neighbours of two sets in one frame.
///
/// Of several nearest points the one with the lowest index counts. So each point is in at most one match, and of equal
/// points in one set only the first can be matched.
/// @param tolerance  metres; matched points are at most this far apart
/// @return the matches in the order of `first`; empty if a set is empty
/// Errors: kInvalidField if the tolerance is negative or not finite; those of check_points().
/// Cost: O(n log n) of the points.
[[nodiscard]] Result<std::vector<Match>> match(std::span<const Point2> first, std::span<const Point2> second,
                                               double tolerance = kTolerance);

} // namespace scanloom::landmarks
