#pragma once

#include "robot_client/source/locate.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <optional>

namespace scanloom::robot {

/// Metres along each axis: the farthest that a robot with a given first place is carried before it is stationary again.
inline constexpr double kCarriedMax = 100.0;

/// Makes a Locate that asks the server for the robot's position, as ask_once_applied() does.
/// @param near         where the robot stands first; each later place is within kCarriedMax of the previous result.
///                     None: anywhere in the map
/// @param first_place  metres in the map frame; the assumed place if no map exists at the first request
/// Errors: of the returned function: the server's refusal, e.g. kAmbiguous, kUndetermined or kNothingMapped;
///         kOverloaded if link::OpenRequests::kMax requests are open.
[[nodiscard]] Locate located_by(Uplink& uplink, const std::optional<wire::Near>& near, const Point2& first_place);

} // namespace scanloom::robot
