#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/scan_log.hpp"

namespace scanloom::http {

/// GET .../log: the session's log up to its newest entry, whole.
///   format=protobuf (or none)  each entry as a scanloom.v1.LogEntry, its length before it: uint32, big-endian
///   format=clf                 as a CARMEN log (exchange/carmen_text.hpp)
[[nodiscard]] Result<Response> get_log(session::SessionRegistry& sessions, store::ScanLog& log, const Call& call);

} // namespace scanloom::http
