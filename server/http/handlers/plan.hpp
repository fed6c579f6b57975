#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// POST .../plan {from, to, allow_unknown?, body_radius?, danger_cost?}: returns the cheapest path as a LineString, or
/// 409 with the reason if there is none. `from` may be {"robot": name}.
[[nodiscard]] Result<Response> post_plan(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
