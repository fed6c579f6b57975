#pragma once

#include "load/core/audience_figures.hpp"
#include "load/net/http_connection.hpp"
#include "load/net/run_clock.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <string>

namespace scanloom::load {

/// State shared by the viewers and tile readers of one thread.
struct OnlookerShared {
    const RunClock& clock;
    HttpPlace http;
    AudienceFigures& figures;
    bool stopped = false; ///< every reader and viewer ends once it is set
};

/// Watches a session over a WebSocket as the viewer's page does: all layers and points, reading every event
/// immediately. Reconnects a second after a connection ended or was refused. `shared` must live until the executor has
/// stopped.
[[nodiscard]] boost::asio::awaitable<void> watch(OnlookerShared& shared, std::string session);

/// Fetches the tiles of a session one after the other, again and again, `rate` per second, each with its last ETag, as
/// a browser does. Starts after `delay`, so that readers do not send requests in step.
[[nodiscard]] boost::asio::awaitable<void> read_tiles(OnlookerShared& shared, std::string session, double rate,
                                                      Micros delay);

} // namespace scanloom::load
