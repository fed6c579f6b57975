#pragma once

#include "server/guide/way_book.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../goals.geojson: returns for each robot its last planned path and its assigned goal, if any. The revision is
/// that of the WayBook, as LiveEvent::goals_revision. Assigns nothing.
[[nodiscard]] Result<Response> get_goals(session::SessionRegistry& sessions, guide::WayBook& ways,
                                         const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
