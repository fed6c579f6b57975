#pragma once

#include "robot_client/source/next_goal.hpp"
#include "robot_client/uplink/uplink.hpp"

namespace scanloom::robot {

/// Asks the server where to explore next, once all scans that were taken so far are in its maps: so the answer depends
/// on the scans alone, however long they were on their way.
/// Errors of what it gives  the server's refusal; kOverloaded: OpenRequests::kMax are open.
[[nodiscard]] NextGoal guided_by(Uplink& uplink, double body_radius_m);

} // namespace scanloom::robot
