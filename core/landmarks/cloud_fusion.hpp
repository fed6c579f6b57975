#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/landmarks/captures.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// A point of a fused cloud.
struct FusedPoint {
    Point2 position;    ///< metres; if only one cloud saw it, exactly its coordinates
    std::size_t clouds; ///< how many clouds saw it, at least 1
    std::size_t first;  ///< index of the first cloud that saw it
};

/// Fuses several clouds into one. Points of different clouds that correspond become one point; all others stay.
///
/// The clouds are processed in their order; each point of the first cloud starts a group. The points of each further
/// cloud are matched with the groups found so far, as match() does: mutual nearest neighbours at most `threshold`
/// apart, where the position of a group is the per-axis median of its points (of an even number, the mean of the middle
/// two). A matched point joins its group; any other point starts a new one. So a group has at most one point of each
/// cloud, and equal points of one cloud remain separate. The fused points are the medians of the groups. Their counts
/// of clouds add up to the number of points of all clouds.
/// @param clouds     metres, all in one frame
/// @param threshold  metres
/// @param ask        called before each cloud, because many clouds take seconds; an error that it returns ends the
///     fusion
/// @return the fused points, in the order in which their groups started
/// Errors: kInvalidField if the threshold is negative or not finite; those of check_points() and `ask`.
/// Cost: for each cloud O(n log n) of its points and the groups around them; for each point that joins a group, the
///     size of the group.
[[nodiscard]] Result<std::vector<FusedPoint>> fuse(
    std::span<const std::vector<Point2>> clouds, double threshold,
    const std::function<Result<>()>& ask = [] { return Result<>(); });

/// A point of a session's fused cloud.
struct CloudPoint {
    double angle = 0.0;        ///< radians, counter-clockwise from the robot's heading, in (-pi, pi]
    double distance = 0.0;     ///< metres from the robot's position
    Point2 position{0.0, 0.0}; ///< metres, map frame
    std::size_t seen = 0;      ///< number of keyframes that show it
    RobotIndex robot = 0;      ///< of the first of them; angle and distance are relative to its pose
    Revision revision = 0;     ///< log entry at which the first of them ended
};

/// Fuses the points of keyframes into one cloud; see fuse().
/// @param captures   points in millimetres of the map frame
/// @param threshold  metres
/// @param ask        see fuse()
/// @return the points, in the order in which they were first seen
/// Errors: those of fuse().
[[nodiscard]] Result<std::vector<CloudPoint>> fuse_captures(
    std::span<const RobotCapture> captures, double threshold,
    const std::function<Result<>()>& ask = [] { return Result<>(); });

} // namespace scanloom::landmarks
