#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../tiles/{layer}.json: TileJSON 3.0.0. Its own bounds and center are longitudes and latitudes,
/// so the map's metres are in members of ours: cell_size, extent (what the tiles cover), bounds_m (what
/// was seen), frame_id.
[[nodiscard]] Result<Response> get_tilejson(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
