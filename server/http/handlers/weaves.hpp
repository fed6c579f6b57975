#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// POST .../weave: maps of the same log with other settings, or up to `until`. 202 while it lasts, 200 when they are
/// there already; `weave={id}` then shows them at every address of maps.
[[nodiscard]] Result<Response> start_weave(const MapsLookup& maps, const Call& call);

/// GET .../weave: all that there are of the session, the last used first.
[[nodiscard]] Result<Response> list_weaves(const MapsLookup& maps, const Call& call);

/// GET .../weave/{weave}: how far it is.
[[nodiscard]] Result<Response> get_weave(const MapsLookup& maps, const Call& call);

/// DELETE .../weave/{weave}: cancels and forgets it.
[[nodiscard]] Result<Response> delete_weave(const MapsLookup& maps, const Call& call);

} // namespace scanloom::http
