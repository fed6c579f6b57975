#pragma once

#include "server/http/api.hpp"
#include "server/http/server_config.hpp"
#include "server/live/viewer_limits.hpp"
#include "server/metrics/metrics.hpp"

namespace scanloom::http {

/// State that all connections of a server share.
struct Service {
    ServerConfig config;
    bool check_host = true;
    const Api& api;
    metrics::HttpCounters& counters;
    live::ViewerSemaphore viewers; ///< connections of live viewers
};

} // namespace scanloom::http
