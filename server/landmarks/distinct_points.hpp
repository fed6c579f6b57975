#pragma once

#include "common/geometry/pose2.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// A cloud's points with equal ones merged: a stationary lidar measures the same points repeatedly. They are in the
/// order of their first occurrence, so of two distinct points the one with the lower number also has the lower index in
/// the cloud.
struct DistinctPoints {
    std::vector<Point2> points;
    std::vector<std::uint32_t> counts; ///< for each distinct point, how many points of the cloud are equal to it
    std::vector<std::uint32_t> of;     ///< for each point of the cloud, the number of its distinct point
};

/// Merges the equal points of a cloud.
/// Precondition: the points pass check_points().
/// Cost: O(n log n).
[[nodiscard]] DistinctPoints distinct_points(std::span<const Point2> cloud);

} // namespace scanloom::landmarks
