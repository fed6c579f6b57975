#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"

namespace scanloom::http {

/// GET /openapi.json: returns server/http/openapi.json, which is compiled in.
[[nodiscard]] Result<Response> get_openapi(const Call& call);

} // namespace scanloom::http
