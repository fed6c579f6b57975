#pragma once

#include "robot_client/source/locate.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <optional>

namespace scanloom::robot {

/// Asks the server where the robot is, as ask_once_applied() does.
/// @param near  where it must be; none: anywhere in the map
/// Errors of what it gives  the server's refusal, e.g. kAmbiguous, kUndetermined, kNothingMapped; kOverloaded:
///                          OpenRequests::kMax are open.
[[nodiscard]] Locate located_by(Uplink& uplink, std::optional<wire::Near> near);

} // namespace scanloom::robot
