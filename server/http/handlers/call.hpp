#pragma once

#include "server/http/request.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"

namespace scanloom::http {

/// A request that found its handler: what its path and query say, and the rest of it.
struct Call {
    const Request& request;
    const Arguments& arguments;
    const Query& query;
};

} // namespace scanloom::http
