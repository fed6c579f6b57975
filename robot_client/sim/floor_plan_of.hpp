#pragma once

#include "robot_client/drive/ground.hpp"
#include "robot_client/sim/truth_grid.hpp"

namespace scanloom::robot {

/// Returns the floor plan of a known world for a robot.
[[nodiscard]] FloorPlan floor_plan_of(const TruthGrid& truth);

} // namespace scanloom::robot
