#pragma once

#include "common/error/error.hpp"
#include "server/guide/way_book.hpp"
#include "server/http/doorman.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/live/landmark_hub.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// Accepts a WebSocket that watches the session: 101 with an invitation. Responds 426 if the request is not for a
/// WebSocket of version 13, and 403 to a page of another host, because browsers let any page open a WebSocket and read
/// it. The viewer watches as long as its token permits it.
/// Errors: kInvalidField for an unknown parameter; those of find_session().
[[nodiscard]] Result<Response> get_live(session::SessionRegistry& sessions, guide::WayBook& ways,
                                        live::LandmarkHub& landmarks, const Doorman& doorman, const Call& call);

} // namespace scanloom::http
