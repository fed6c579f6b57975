#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// POST .../exclude: excludes scans of a robot from the maps. 201; the maps are then computed again from the log.
[[nodiscard]] Result<Response> exclude_scans(session::SessionRegistry& sessions, const Call& call);

/// GET .../exclusions: those in effect, by rising id.
[[nodiscard]] Result<Response> list_exclusions(session::SessionRegistry& sessions, const Call& call);

/// DELETE .../exclusions/{exclusion}: lifts it; the maps are then computed again from the log.
[[nodiscard]] Result<Response> lift_exclusion(session::SessionRegistry& sessions, const Call& call);

} // namespace scanloom::http
