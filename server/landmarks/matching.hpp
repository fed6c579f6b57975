#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr double kTolerance = 0.25; ///< metres

/// A point of one set and one of another that are each other's nearest.
struct Match {
    std::size_t first;  ///< index in the first set
    std::size_t second; ///< index in the second set
    double distance;    ///< metres

    friend bool operator==(const Match&, const Match&) = default;
};

/// Mutual nearest neighbours at most `tolerance` apart, both sets in one frame. Of several nearest the lowest index
/// counts; so each point is in one match at most, and of equal points in one set only the first can be.
/// @return in the order of `first`; empty where a set is
/// Errors  kInvalidField: a tolerance that is negative or not finite. Those of check_points().
/// Cost    n log n of the points.
[[nodiscard]] Result<std::vector<Match>> match(std::span<const Point2> first, std::span<const Point2> second,
                                               double tolerance = kTolerance);

} // namespace scanloom::landmarks
