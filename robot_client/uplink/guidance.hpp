#pragma once

#include "robot_client/source/next_goal.hpp"
#include "robot_client/uplink/uplink.hpp"

namespace scanloom::robot {

/// Makes a NextGoal that asks the server for the next exploration goal once all scans taken so far are in its maps. So
/// the goal depends only on the scans, not on how long their transmission took.
/// @param body_radius_m  metres
/// Errors: of the returned function: the server's refusal; kOverloaded if link::OpenRequests::kMax requests are open.
[[nodiscard]] NextGoal guided_by(Uplink& uplink, double body_radius_m);

} // namespace scanloom::robot
