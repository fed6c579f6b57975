#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/scan_log.hpp"

namespace scanloom::http {

/// GET .../log: returns the session's whole log up to its newest entry.
///   format=protobuf (default)  each entry as a scanloom.v1.LogEntry after its length: uint32, big-endian
///   format=clf                 as a CARMEN log (exchange/carmen_text.hpp)
[[nodiscard]] Result<Response> get_log(session::SessionRegistry& sessions, store::ScanLog& log, const Call& call);

} // namespace scanloom::http
