#pragma once

#include "common/error/error.hpp"
#include "server/guide/way_book.hpp"
#include "server/http/doorman.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/live/landmark_hub.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// Lets a WebSocket in that watches the session: 101, with an invitation. 426 when no WebSocket of version 13 is asked
/// for, 403 when a page of another host asks for it: browsers let any page open one and show what comes. The viewer
/// watches for as long as its token allows it.
/// Errors  kInvalidField: an unknown parameter; those of find_session().
[[nodiscard]] Result<Response> get_live(session::SessionRegistry& sessions, guide::WayBook& ways,
                                        live::LandmarkHub& landmarks, const Doorman& doorman, const Call& call);

} // namespace scanloom::http
