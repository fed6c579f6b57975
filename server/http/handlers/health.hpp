#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/scan_log.hpp"

namespace scanloom::http {

/// GET /livez: the process answers.
[[nodiscard]] Result<Response> get_livez(const Call& call);

/// GET /readyz: 200, or 503 with the reasons: sessions not recovered yet, draining, a failed store.
[[nodiscard]] Result<Response> get_readyz(const session::SessionRegistry& sessions, const store::ScanLog& log,
                                          bool recovered, const Call& call);

} // namespace scanloom::http
