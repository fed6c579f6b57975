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

/// GET /api/v1/sessions: lists at most `limit` (1..1000, default 100) sessions that the token is for, by ascending
/// name, starting after the name `after`. Sessions with a damaged log are included and marked. For sessions that are
/// served despite damage, "damage" contains the finding of `check`.
/// @param check  null if there is no background check
[[nodiscard]] Result<Response> list_sessions(const session::SessionRegistry& sessions,
                                             const session::BackgroundCheck* check, const Call& call);

/// POST /api/v1/sessions
[[nodiscard]] Result<Response> create_session(session::SessionRegistry& sessions, const Doorman& doorman,
                                              const Call& call);

/// GET /api/v1/sessions/{session}
[[nodiscard]] Result<Response> get_session(const session::SessionRegistry& sessions,
                                           const session::BackgroundCheck* check, const Call& call);

/// The objects that must forget a deleted session.
struct Forgetful {
    session::Weaves& weaves;
    session::LandmarkFolds& landmarks;
    guide::Locator* locator; ///< null if there is no relocalization
    tiles::TileMaker& tiles;
};

/// DELETE /api/v1/sessions/{session}
[[nodiscard]] Result<Response> delete_session(session::SessionRegistry& sessions, const Forgetful& forgetful,
                                              const Call& call);

} // namespace scanloom::http
