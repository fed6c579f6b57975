#pragma once

#include "core/scan_matching/point_map.hpp"
#include "core/scan_matching/seen_space.hpp"

#include <span>

namespace scanloom::scan_matching {

/// How well a scan at one pose agrees with a map.
struct Agreement {
    double inlier_ratio = 0.0;  ///< ratio of points within kInlierDistance of the map
    double outlier_ratio = 0.0; ///< ratio of points in space that the map's views saw free
    double score = 0.0; ///< sum over the points of a weight by their distance from the map's lines, minus 1.5 for
                        ///< each outlier, by the number of points; at most 1
};

/// Compares a scan with a map at one pose.
/// @param points       robot frame
/// @param map          the points of the map
/// @param space        the space that the same views saw
/// @param T_map_robot  the pose
/// @return all 0 if there are no points
[[nodiscard]] Agreement agreement_of(std::span<const SurfacePoint> points, const PointMap& map, const SeenSpace& space,
                                     const Transform2& T_map_robot);

} // namespace scanloom::scan_matching
