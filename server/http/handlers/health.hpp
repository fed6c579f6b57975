#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/background_check.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <string>

namespace scanloom::http {

/// Where robots connect.
struct RobotPort {
    std::string host; ///< an address; empty when every address of this machine will do
    std::uint16_t port = 0;
};

/// GET /livez: the process answers.
[[nodiscard]] Result<Response> get_livez(const Call& call);

/// GET /readyz: 200 with the sessions that are damaged or take no scans and where robots connect, or 503 with the
/// reasons: sessions not recovered yet, draining, a failed store. It waits for nothing. Sessions are named to those
/// alone whose token is for them.
/// @param check  null: none is made.
[[nodiscard]] Result<Response> get_readyz(const session::SessionRegistry& sessions,
                                          const session::BackgroundCheck* check, const store::ScanLog& log,
                                          bool recovered, const RobotPort& robots, const Call& call);

} // namespace scanloom::http
