#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../frontiers.geojson?robot&size_min&body_radius: returns a feature for each frontier, largest first: its cells
/// as areas, and the goal for exploring it with the cheapest path from the named robot, or from any robot.
[[nodiscard]] Result<Response> get_frontiers(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
