#pragma once

#include "server/guide/locator.hpp"
#include "server/http/doorman.hpp"
#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/background_check.hpp"
#include "server/session/capture_folds.hpp"
#include "server/session/session_registry.hpp"
#include "server/session/weaves.hpp"
#include "server/tiles/tile_maker.hpp"

namespace scanloom::http {

/// GET /api/v1/sessions: by rising name, at most `limit` (1..1000, default 100) names after `after`;
/// those whose log is damaged, too, marked so. Only those that the token is for.
/// Of those that are served all the same, "damage" says what `check` found.
/// @param check  null: none is made.
[[nodiscard]] Result<Response> list_sessions(const session::SessionRegistry& sessions,
                                             const session::BackgroundCheck* check, const Call& call);

/// POST /api/v1/sessions
[[nodiscard]] Result<Response> create_session(session::SessionRegistry& sessions, const Doorman& doorman,
                                              const Call& call);

/// GET /api/v1/sessions/{session}
[[nodiscard]] Result<Response> get_session(const session::SessionRegistry& sessions,
                                           const session::BackgroundCheck* check, const Call& call);

/// Who forgets a session that is deleted.
struct Forgetful {
    session::Weaves& weaves;
    session::LandmarkFolds& landmarks;
    guide::Locator* locator; ///< null: nobody asks where they are
    tiles::TileMaker& tiles;
};

/// DELETE /api/v1/sessions/{session}
[[nodiscard]] Result<Response> delete_session(session::SessionRegistry& sessions, const Forgetful& forgetful,
                                              const Call& call);

} // namespace scanloom::http
