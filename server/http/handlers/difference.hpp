#pragma once

#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../difference, .../difference.png `?weave=A&with=B&layer&bbox`: what two maps of a session disagree in, in
/// numbers or as an image; either is a weave, or when it is not named the session's own map. See
/// tiles/difference.hpp.
///
/// The image tells by `Scanloom-Bounds: min_x,min_y,max_x,max_y` where in the map frame it lies; metres. It takes a
/// slot, as map.png does.
[[nodiscard]] Result<Response> get_difference(const MapsLookup& maps, const Call& call);
[[nodiscard]] Result<Response> get_difference_png(const MapsLookup& maps, const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
