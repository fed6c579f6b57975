#pragma once

#include "server/http/doorman.hpp"
#include "server/http/handlers/call.hpp"

namespace scanloom::http {

/// GET /api/v1/login: returns whether this server requires tokens, and the properties of the request's token if it is
/// known.
[[nodiscard]] Result<Response> get_login(const Doorman& doorman, const Call& call);

/// POST /api/v1/login {"token": "..."}: signs a browser in with a cookie that scripts cannot read. Responds as GET
/// /login, or 401 if the token is not valid.
/// Errors: kMalformed or kInvalidField for the body.
[[nodiscard]] Result<Response> post_login(const Doorman& doorman, const Call& call);

/// DELETE /api/v1/login: signs the browser out. Responds 204, also if it was not signed in.
[[nodiscard]] Result<Response> delete_login(const Doorman& doorman, const Call& call);

} // namespace scanloom::http
