#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/metrics/metrics.hpp"
#include "server/session/background_check.hpp"
#include "server/session/session_registry.hpp"
#include "server/session/weaves.hpp"
#include "server/store/scan_log.hpp"
#include "server/tiles/tile_cache.hpp"

namespace scanloom::http {

/// GET /metrics: returns the counters and the current state of the process, the store and the sessions.
/// @param check  null if there is no background check
[[nodiscard]] Result<Response> get_metrics(const metrics::Metrics& counted, const session::SessionRegistry& sessions,
                                           const session::BackgroundCheck* check, const session::Weaves& weaves,
                                           const store::ScanLog& log, const tiles::TileCache::Stats& tiles,
                                           const Call& call);

} // namespace scanloom::http
