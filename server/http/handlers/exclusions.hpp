#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// POST .../exclude: excludes scans of a robot from the maps, which are computed again when they are next asked for.
[[nodiscard]] Result<Response> exclude_scans(session::SessionRegistry& sessions, const Call& call);

/// GET .../exclusions: those in effect, by rising id.
[[nodiscard]] Result<Response> list_exclusions(const session::SessionRegistry& sessions, const Call& call);

/// DELETE .../exclusions/{exclusion}: lifts it, likewise.
[[nodiscard]] Result<Response> lift_exclusion(session::SessionRegistry& sessions, const Call& call);

} // namespace scanloom::http
