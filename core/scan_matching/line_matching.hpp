#pragma once

#include "core/scan_matching/point_map.hpp"

#include <span>

namespace scanloom::scan_matching {

/// Where a scan is expected, and how certain that is. Precondition: sigmas are positive and at most 100.
struct PosePrior {
    Transform2 T_map_robot;      ///< where it is expected
    double position_sigma = 0.1; ///< metres
    double yaw_sigma = 0.1;      ///< radians
};

/// How match_to_lines() proceeds: gate and scale shrink from their first to their last values. Precondition: gates,
/// scales and point_sigma are positive.
struct MatchSchedule {
    int steps_max = 12;        ///< Gauss-Newton steps
    double first_gate = 0.6;   ///< metres: points farther than this from the map have no partner
    double last_gate = 0.2;    ///< metres
    double first_scale = 0.25; ///< metres: residual at which the weight of a pair has fallen to a quarter
    double last_scale = 0.06;  ///< metres
    double point_sigma = 0.05; ///< metres: error of one point, correlated errors of neighbours included
};

/// The result of match_to_lines().
struct LineMatch {
    Transform2 T_map_robot;      ///< the refined pose
    bool is_refined = true;      ///< false: the refinement failed, and T_map_robot is the start
    double inlier_ratio = 0.0;   ///< of the scan's points, those within kInlierDistance of a point of the map
    double position_sigma = 0.0; ///< metres, standard deviation in the most uncertain direction, with the prior
    double yaw_sigma = 0.0;      ///< radians, likewise
    double conditioning = 0.0;   ///< smallest by largest information about the position, over all directions; 0: the
                                 ///< scan does not determine the position along some line
};

inline constexpr float kInlierDistance = 0.15F; ///< metres

/// Returns the ratio of points within kInlierDistance of the map.
/// @param points       of a scan, robot frame
/// @param map          the map
/// @param T_map_robot  pose of the scan
/// @return 0 to 1; 0 without points
[[nodiscard]] double inlier_ratio(std::span<const SurfacePoint> points, const PointMap& map,
                                  const Transform2& T_map_robot);

/// Refines the pose of a scan so that its points lie on the lines of the map's surfaces. Gauss-Newton steps with new
/// partners in every step; pairs with large residuals lose their weight, so people and moved furniture matter little.
/// @param points  robot frame
/// @param map     the map to match
/// @param start   the pose to refine, T_map_robot
/// @param prior   keeps the pose near the expected one in directions that the map does not determine
/// @param schedule  steps, gates and scales
/// @return the refined pose; `start` with `is_refined` = false if the equations are singular, or if the result would be
///     more than 3 m from `start`
/// Source: Censi, An ICP variant using a point-to-line metric (2008); weights of Geman and McClure (1987).
[[nodiscard]] LineMatch match_to_lines(std::span<const SurfacePoint> points, const PointMap& map,
                                       const Transform2& start, const PosePrior& prior, const MatchSchedule& schedule);

} // namespace scanloom::scan_matching
