#pragma once

#include "robot_client/source/locate.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <optional>

namespace scanloom::robot {

/// Metres along each axis: a robot of which was said where it stands first is not carried further before it stands
/// again.
inline constexpr double kCarriedMax = 100.0;

/// Asks the server where the robot is, as ask_once_applied() does.
/// @param near         where it stands first; each further place is within kCarriedMax of the one that was told before.
///                     None: anywhere in the map
/// @param first_place  where it is taken to stand if nothing is mapped when it asks first
/// Errors of what it gives  the server's refusal, e.g. kAmbiguous, kUndetermined, kNothingMapped; kOverloaded:
///                          OpenRequests::kMax are open.
[[nodiscard]] Locate located_by(Uplink& uplink, const std::optional<wire::Near>& near, const Point2& first_place);

} // namespace scanloom::robot
