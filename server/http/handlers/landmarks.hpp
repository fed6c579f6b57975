#pragma once

#include "common/error/error.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/capture_folds.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../landmarks.geojson?since&bbox&seen_min: the session's landmarks as points, by id, in metres of the map frame:
/// all of them, or those that were seen after `since`, whose position lies in `bbox`, that at least `seen_min` captures
/// saw. The collection tells how alike what robots saw in succession was: persistence, stability and continuity, each
/// a mean, null where there is nothing to tell. "revision" is what to ask for as `since` the next time; "reset": the
/// session has not come as far as `since`, it was made anew, and all are told.
/// Waits for the log to be read, which takes seconds where nobody has asked for a long one before.
/// Errors  those of find_session(), LandmarkFolds::up_to(); kInvalidField: a parameter.
[[nodiscard]] Result<Response> get_landmarks(session::SessionRegistry& sessions, session::LandmarkFolds& folds,
                                             const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
