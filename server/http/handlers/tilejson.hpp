#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../tiles/{layer}.json: returns TileJSON 3.0.0. Its bounds and center are longitudes and latitudes, so metres
/// are in additional members: cell_size, extent (covered by the tiles), bounds_m (the observed area), frame_id.
[[nodiscard]] Result<Response> get_tilejson(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
