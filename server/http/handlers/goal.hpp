#pragma once

#include "server/guide/goal_book.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../goal?robot=: the goal that the robot holds, and the way there: `"outcome": "none"` where it holds none,
/// "complete" where nothing was left that it could explore. Assigns nothing.
/// Errors  kInvalidField, kNotFound: the robot.
[[nodiscard]] Result<Response> get_goal(session::SessionRegistry& sessions, guide::WayBook& ways,
                                        const AnswerSlots& slots, const Call& call);

/// POST .../goal {robot, size_min?, body_radius?}: assigns to the robot what it should explore next. From now on no
/// other robot is given the same frontier; see GoalBook.
[[nodiscard]] Result<Response> assign_goal(const MapsLookup& maps, guide::GoalBook& goals, const AnswerSlots& slots,
                                           const Call& call);

} // namespace scanloom::http
