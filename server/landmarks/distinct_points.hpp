#pragma once

#include "common/geometry/pose2.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// A cloud's points with equal ones put together: a lidar that stands still measures the same again and again.
/// In the order in which they came first, so that of two distinct points the one with the lower number also has the
/// lower index in the cloud.
struct DistinctPoints {
    std::vector<Point2> points;
    std::vector<std::uint32_t> counts; ///< how many of the cloud are equal to each
    std::vector<std::uint32_t> of;     ///< for each point of the cloud, the distinct one it is equal to
};

/// Cost  n log n.
/// Pre   the points pass check_points().
[[nodiscard]] DistinctPoints distinct_points(std::span<const Point2> cloud);

} // namespace scanloom::landmarks
