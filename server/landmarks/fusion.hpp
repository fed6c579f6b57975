#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <functional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

struct FusedPoint {
    Point2 position;    ///< metres; of one cloud alone: its very coordinates
    std::size_t clouds; ///< how many of them saw it, 1 or more
    std::size_t first;  ///< the first of them, by its index
};

/// One cloud of many. Points of different clouds that correspond become one; all others stay.
///
/// What corresponds: the clouds are taken in their order, and each point of the first is a group. The points of each
/// further cloud are matched with the groups so far, as match() does: mutual nearest neighbours at most `threshold`
/// apart, a group standing where the per-axis median of its points is (of an even number, the mean of the middle
/// two). A point that is matched joins its group, one that is not begins a new one. So a group has at most one point of
/// a cloud, and equal points of one cloud stay as many as they are. The fused points are the groups' medians.
///
/// Frames  all clouds in one frame; see transform_points().
/// @return in the order in which the groups began
/// Post    as many clouds seen, over all fused points, as there are points in all clouds.
/// @param ask  before each cloud, as many take seconds; its error ends it
/// Errors  kInvalidField: a threshold that is negative or not finite. Those of check_points() and of `ask`.
/// Cost    for each cloud n log n of its points and of the groups around, and of each point that joins a group, its members.
[[nodiscard]] Result<std::vector<FusedPoint>> fuse(
    std::span<const std::vector<Point2>> clouds, double threshold,
    const std::function<Result<>()>& ask = [] { return Result<>(); });

} // namespace scanloom::landmarks
