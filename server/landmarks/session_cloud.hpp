#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/session_captures.hpp"

#include <functional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

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
/// @param threshold  metres
/// @return the points, in the order in which they were first seen
/// Errors: those of fuse().
[[nodiscard]] Result<std::vector<CloudPoint>> fuse_captures(
    std::span<const RobotCapture> captures, double threshold,
    const std::function<Result<>()>& ask = [] { return Result<>(); });

} // namespace scanloom::landmarks
