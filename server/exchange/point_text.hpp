#pragma once

#include "server/landmarks/session_cloud.hpp"

#include <span>
#include <string>
#include <vector>

/// A session's fused cloud as files. Metres to a tenth of a millimetre, map frame.
namespace scanloom::exchange {

/// About how much text a point takes, in either file: bytes.
inline constexpr std::size_t kPointTextBytes = 64;

/// A line for each point, after one with the names: angle,distance,x,y,seen,robot,revision. Angle in radians and
/// distance are the fused point's, from the robot that saw it first.
/// @param robots  names by RobotIndex; they need no quotes
[[nodiscard]] std::string points_csv(std::span<const landmarks::CloudPoint> points,
                                     std::span<const std::string> robots);

/// Polygon File Format 1.0, ASCII: vertices with x, y, z, which is 0, and by how many captures each was seen.
[[nodiscard]] std::string points_ply(std::span<const landmarks::CloudPoint> points);

} // namespace scanloom::exchange
