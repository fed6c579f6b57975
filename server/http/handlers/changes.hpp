#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET .../changes?layer&since: every tile of every zoom that was touched after revision `since`.
/// A `since` beyond the revision now is of a session that was deleted and made anew: every tile is told.
[[nodiscard]] Result<Response> get_changes(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
