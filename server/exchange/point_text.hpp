#pragma once

#include "core/landmarks/cloud_fusion.hpp"

#include <span>
#include <string>
#include <vector>

/// Writes a session's fused point cloud as files. Coordinates are in metres, in the map frame, with a resolution of a
/// tenth of a millimetre.
namespace scanloom::exchange {

/// Approximate size of a point's text in any file, in bytes.
inline constexpr std::size_t kPointTextBytes = 64;

/// Returns the points as CSV: a line with the column names angle,distance,x,y,seen,robot,revision, then one line per
/// point. Angle (radians) and distance are those of the fused point, from the robot that saw it first.
/// @param robots  names by RobotIndex; they need no quotes
[[nodiscard]] std::string points_csv(std::span<const landmarks::CloudPoint> points,
                                     std::span<const std::string> robots);

/// Returns the points as an ASCII file in the Polygon File Format 1.0. A vertex has x, y, z = 0, and the number of
/// captures in which the point was seen.
[[nodiscard]] std::string points_ply(std::span<const landmarks::CloudPoint> points);

/// Returns the points as an ASCII file of the Point Cloud Library, version 0.7, with the same four values.
/// Source: https://pcl.readthedocs.io/projects/tutorials/en/latest/pcd_file_format.html
[[nodiscard]] std::string points_pcd(std::span<const landmarks::CloudPoint> points);

} // namespace scanloom::exchange
