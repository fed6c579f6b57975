#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET /openapi.json: server/http/openapi.json, compiled in.
[[nodiscard]] Result<Response> get_openapi(const Call& call);

} // namespace scanloom::http
