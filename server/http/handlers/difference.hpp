#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../difference, .../difference.png `?weave=A&with=B&layer&bbox`: returns the differences between two maps of a
/// session, as numbers or as an image. Each map is that of a replay job, or the session's own map if it is not named.
/// See tiles/difference.hpp.
///
/// The image has `Scanloom-Bounds: min_x,min_y,max_x,max_y`, its bounds in the map frame in metres. It takes a slot, as
/// map.png does.
[[nodiscard]] Result<Response> get_difference(const MapsLookup& maps, const Call& call);
[[nodiscard]] Result<Response> get_difference_png(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
