#pragma once

#include "server/guide/goal_book.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../goal?robot=: returns the robot's current goal and the path to it. The outcome is "none" if it has no goal
/// and "complete" if nothing was left that it could explore. Assigns nothing.
/// Errors: kInvalidField or kNotFound for the robot.
[[nodiscard]] Result<Response> get_goal(session::SessionRegistry& sessions, guide::WayBook& ways,
                                        const AnswerSlots& slots, const Call& call);

/// POST .../goal {robot, size_min?, body_radius?}: assigns to the robot the next frontier to explore. No other robot is
/// assigned the same frontier from then on; see GoalBook.
[[nodiscard]] Result<Response> assign_goal(const MapsLookup& maps, guide::GoalBook& goals, const AnswerSlots& slots,
                                           const Call& call);

} // namespace scanloom::http
