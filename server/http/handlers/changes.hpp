#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../changes?layer&since: lists every tile of every zoom that changed after revision `since`. If `since` is
/// greater than the current revision, the session was recreated, and every tile is listed.
[[nodiscard]] Result<Response> get_changes(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
