#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/session_captures.hpp"

#include <functional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// A point of a session's fused cloud.
struct CloudPoint {
    double angle = 0.0;        ///< radians, counter-clockwise from where the robot looked, in (-pi, pi]
    double distance = 0.0;     ///< metres from where the robot stood
    Point2 position{0.0, 0.0}; ///< metres, map frame
    std::size_t seen = 0;      ///< by so many captures
    RobotIndex robot = 0;      ///< of the first of them, which angle and distance are of
    Revision revision = 0;     ///< log entry at which this one ended
};

/// What robots saw from many places as one cloud: see fuse(). In the order in which the points were seen first.
/// Errors  those of fuse().
[[nodiscard]] Result<std::vector<CloudPoint>> fuse_captures(
    std::span<const RobotCapture> captures, double threshold,
    const std::function<Result<>()>& ask = [] { return Result<>(); });

} // namespace scanloom::landmarks
