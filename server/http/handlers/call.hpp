#pragma once

#include "server/access/token.hpp"
#include "server/http/request.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"

namespace scanloom::http {

/// A request that found its handler: what its path and query say, and the rest of it.
struct Call {
    const Request& request;
    const Arguments& arguments;
    const Query& query;
    access::TokenRef token = nullptr; ///< of who asks; null only where anybody may
};

} // namespace scanloom::http
