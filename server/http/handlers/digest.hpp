#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../digest?layer: a hash over the canonical cells of each layer; equal digests are equal maps.
[[nodiscard]] Result<Response> get_digest(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
