#pragma once

#include "server/access/token.hpp"
#include "server/http/request.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"

namespace scanloom::http {

/// A routed request: the arguments of its path, its query, and the request itself.
struct Call {
    const Request& request;
    const Arguments& arguments;
    const Query& query;
    access::TokenRef token = nullptr; ///< of the client; null only if the operation needs no token
};

} // namespace scanloom::http
