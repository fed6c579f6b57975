#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <vector>

/// What robots are told. Everything in metres of the map frame; a revision is that of the maps searched.
namespace scanloom::guide {

struct Goal {
    Point2 place{0.0, 0.0};  ///< where to stand
    Point2 target{0.0, 0.0}; ///< what to look at
    bool in_danger = false;  ///< the place is, as there was no other
    Revision revision = 0;
};

enum class WayKind { kGoal, kPlan, kCoverage };

struct Way {
    WayKind kind = WayKind::kGoal;
    std::vector<Point2> points;
    double length_m = 0.0; ///< of all of it
    Revision revision = 0;
    std::size_t points_left_out = 0; ///< after these
};

} // namespace scanloom::guide
