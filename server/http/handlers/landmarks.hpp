#pragma once

#include "common/error/error.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/capture_folds.hpp"
#include "server/session/session_registry.hpp"

namespace scanloom::http {

/// GET .../landmarks.geojson?since&bbox&seen_min: returns the session's landmarks as points by id, in metres of the map
/// frame: all of them, or those observed after `since`, with a position in `bbox`, in at least `seen_min` captures. The
/// collection states how consistent successive observations are: persistence, stability and continuity, each a mean,
/// null without data. "revision" is the `since` for the next request. "reset" means that the session has not reached
/// `since` because it was recreated; then all landmarks are returned. Waits until the log has been read, which takes
/// seconds for a long log at the first request.
/// Errors: those of find_session() and LandmarkFolds::up_to(); kInvalidField for a parameter.
[[nodiscard]] Result<Response> get_landmarks(session::SessionRegistry& sessions, session::LandmarkFolds& folds,
                                             const AnswerSlots& slots, const Call& call);

} // namespace scanloom::http
