#pragma once

#include "server/http/doorman.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// POST .../import: creates the session from a ROS map. The form has the fields `yaml` and `image` (PGM or PNG), and
/// any settings of a session. The cell size is that of the map unless cell_size is given. Responds as POST /sessions.
[[nodiscard]] Result<Response> import_map(session::SessionRegistry& sessions, const Doorman& doorman, const Call& call);

} // namespace scanloom::http
