#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <vector>

/// The goals and paths that robots hold. Positions and lengths are in metres of the map frame. A revision is that of
/// the maps that were searched.
namespace scanloom::guide {

struct Goal {
    Point2 place{0.0, 0.0};  ///< where the robot should stand
    Point2 target{0.0, 0.0}; ///< what the robot should observe
    bool in_danger = false;  ///< `place` is in danger, because no other place was found
    Revision revision = 0;
};

enum class WayKind { kGoal, kPlan, kCoverage };

struct Way {
    WayKind kind = WayKind::kGoal;
    std::vector<Point2> points;
    double length_m = 0.0; ///< of the whole path, also of points left out
    Revision revision = 0;
    std::size_t points_left_out = 0; ///< number of points that follow `points`
};

} // namespace scanloom::guide
