#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// POST .../coverage {start?, spacing?, region?, body_radius?}: returns a path over all free ground as a LineString,
/// and the ground that no such path covers as areas. `start` may be {"robot": name}. Without `start`, the path begins
/// at the only robot.
[[nodiscard]] Result<Response> post_coverage(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
