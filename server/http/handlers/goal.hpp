#pragma once

#include "server/guide/goal_book.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../goal?robot&size_min&body_radius: what the robot should explore next, and the way there. From now on no
/// other robot is given the same frontier; see GoalBook.
[[nodiscard]] Result<Response> get_goal(const MapsLookup& maps, guide::GoalBook& goals, const AnswerSlots& slots,
                                        const Call& call);

} // namespace scanloom::http
