#pragma once

#include "server/http/doorman.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// POST .../import: makes the session from a ROS map, a form with the fields `yaml` and `image` (PGM or PNG), and any
/// settings of a session; cells are of the map's size unless cell_size says otherwise. Answers as POST /sessions.
[[nodiscard]] Result<Response> import_map(session::SessionRegistry& sessions, const Doorman& doorman, const Call& call);

} // namespace scanloom::http
