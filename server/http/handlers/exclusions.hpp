#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// POST .../exclude: excludes scans of a robot from the maps. The maps are computed again at the next request for them.
[[nodiscard]] Result<Response> exclude_scans(session::SessionRegistry& sessions, const Call& call);

/// GET .../exclusions: lists the exclusions in effect, by ascending id.
[[nodiscard]] Result<Response> list_exclusions(const session::SessionRegistry& sessions, const Call& call);

/// DELETE .../exclusions/{exclusion}: lifts an exclusion. The maps are computed again at the next request for them.
[[nodiscard]] Result<Response> lift_exclusion(session::SessionRegistry& sessions, const Call& call);

} // namespace scanloom::http
