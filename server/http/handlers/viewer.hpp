#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/http/web_files.hpp"

namespace scanloom::http {

/// GET /: returns the viewer's page. Only the viewer reads the query.
[[nodiscard]] Result<Response> get_viewer(const WebFiles& files, const Call& call);

/// GET /assets/{file}
[[nodiscard]] Result<Response> get_viewer_asset(const WebFiles& files, const Call& call);

} // namespace scanloom::http
