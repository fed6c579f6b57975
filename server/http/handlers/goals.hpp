#pragma once

#include "server/guide/way_book.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../goals.geojson: for each robot the way it planned last and the goal it was given, as far as it has them. Its
/// revision is the book's, as LiveEvent::goals_revision. Gives nobody anything.
[[nodiscard]] Result<Response> get_goals(session::SessionRegistry& sessions, guide::WayBook& ways,
                                         const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
