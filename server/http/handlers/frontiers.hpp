#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../frontiers.geojson?robot&size_min&body_radius: a feature for each frontier, the largest first: its cells as
/// areas, and where to stand to explore it, by the cheapest way from the named robot or from any.
[[nodiscard]] Result<Response> get_frontiers(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
