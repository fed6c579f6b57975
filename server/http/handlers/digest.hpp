#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../digest?layer: returns a hash of the canonical cells of each layer. Equal digests mean equal maps.
[[nodiscard]] Result<Response> get_digest(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
