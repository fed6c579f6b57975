#pragma once

#include "common/link/requests.hpp"
#include "robot_client/sources/live_source.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <boost/asio/awaitable.hpp>

#include <optional>

/// Requests of a robot's program to the server. Each is sent once all scans taken so far are in the server's maps. So
/// the reply depends only on the scans, not on how long their transmission took.
/// Errors of all: the server's refusal; kOverloaded if link::OpenRequests::kMax requests are open.
namespace scanloom::robot {

/// Sends a request, and returns the reply, which may be a refusal. Abandons the request if cancelled. `uplink` must
/// outlive the coroutine.
[[nodiscard]] boost::asio::awaitable<Result<link::Reply>> ask_once_applied(Uplink& uplink, link::Request request);

/// Makes a NextGoal that asks the server for the next exploration goal.
/// @param body_radius_m  metres
[[nodiscard]] NextGoal guided_by(Uplink& uplink, double body_radius_m);

/// Metres along each axis: the farthest that a robot with a given first place is carried before it is stationary again.
inline constexpr double kCarriedMax = 100.0;

/// Makes a Locate that asks the server for the robot's position.
/// @param near         where the robot stands first; each later place is within kCarriedMax of the previous result.
///                     None: anywhere in the map
/// @param first_place  metres in the map frame; the assumed place if no map exists at the first request
/// Errors of the returned function: also kAmbiguous, kUndetermined or kNothingMapped.
[[nodiscard]] Locate located_by(Uplink& uplink, const std::optional<wire::Near>& near, const Point2& first_place);

} // namespace scanloom::robot
