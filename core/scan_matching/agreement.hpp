#pragma once

#include "core/scan_matching/point_map.hpp"
#include "core/scan_matching/seen_space.hpp"

namespace scanloom::scan_matching {

/// How well a scan at one pose agrees with a map.
struct Agreement {
    double inlier_ratio = 0.0;  ///< ratio of points within kInlierDistance of the map
    double outlier_ratio = 0.0; ///< ratio of points in space that the map's views saw free
    /// Sum over the points of a weight by their distance from the map's lines, minus 1.5 for each outlier, by the
    /// number of points where the map shows something, at least half of all; at most 1. What is new to the map counts
    /// neither for nor against a pose: a robot that drives backwards sees much of it, and would seem to stand. Points
    /// behind the map's points are not new: they do not match.
    double score = 0.0;
};

/// Compares a scan with a map at one pose.
/// @param scan         its points
/// @param map          the points of the map
/// @param space        the space that the same views saw
/// @param T_map_robot  the pose
/// @return all 0 if there are no points
[[nodiscard]] Agreement agreement_of(const ScanPoints& scan, const PointMap& map, const SeenSpace& space,
                                     const Transform2& T_map_robot);

} // namespace scanloom::scan_matching
