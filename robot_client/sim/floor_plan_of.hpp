#pragma once

#include "robot_client/drive/ground.hpp"
#include "robot_client/sim/truth_grid.hpp"

namespace scanloom::robot {

/// The plan that a robot is given of a world that is known.
[[nodiscard]] FloorPlan floor_plan_of(const TruthGrid& truth);

} // namespace scanloom::robot
