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
    std::string host; ///< an address; empty: any address of this machine
    std::uint16_t port = 0;
};

/// GET /livez: responds if the process runs.
[[nodiscard]] Result<Response> get_livez(const Call& call);

/// GET /readyz: returns 200 with the address for robots and the sessions that are damaged or accept no scans, or 503
/// with the reasons: sessions not recovered yet, draining, a failed store. Does not wait. Sessions are named only to a
/// client whose token is for them.
/// @param check  null if there is no background check
[[nodiscard]] Result<Response> get_readyz(const session::SessionRegistry& sessions,
                                          const session::BackgroundCheck* check, const store::ScanLog& log,
                                          bool recovered, const RobotPort& robots, const Call& call);

} // namespace scanloom::http
