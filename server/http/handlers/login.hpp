#pragma once

#include "server/http/doorman.hpp"
#include "server/http/handlers/call.hpp"

namespace scanloom::http {

/// GET /api/v1/login: whether tokens are needed here, and what the one is that was shown, if it is known.
[[nodiscard]] Result<Response> get_login(const Doorman& doorman, const Call& call);

/// POST /api/v1/login {"token": "..."}: signs a browser in, with a cookie that no script can read; answers as
/// GET /login. 401 when the token is not in force.
/// Errors  kMalformed, kInvalidField: the body.
[[nodiscard]] Result<Response> post_login(const Doorman& doorman, const Call& call);

/// DELETE /api/v1/login: signs it out; 204, also when it was not signed in.
[[nodiscard]] Result<Response> delete_login(const Doorman& doorman, const Call& call);

} // namespace scanloom::http
