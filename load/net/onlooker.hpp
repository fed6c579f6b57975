#pragma once

#include "load/core/audience_figures.hpp"
#include "load/net/http_place.hpp"
#include "load/net/run_clock.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <string>

namespace scanloom::load {

/// What viewers and tile readers of one thread share.
struct OnlookerShared {
    const RunClock& clock;
    HttpPlace http;
    AudienceFigures& figures;
    bool stopped = false; ///< whoever sees it ends
};

/// Watches a session as a page of the viewer does, over a WebSocket: all layers and points; takes every event as soon
/// as it comes. A connection that ends is made anew after a second, and so it asks again where it is not let in.
/// `shared` stays until the executor has stopped.
[[nodiscard]] boost::asio::awaitable<void> watch(OnlookerShared& shared, std::string session);

/// Fetches the tiles of a session one after the other, round and round, `rate` a second, each with the ETag that it had
/// before, as a browser does. Begins `delay` from now, so that readers do not ask in step.
[[nodiscard]] boost::asio::awaitable<void> read_tiles(OnlookerShared& shared, std::string session, double rate,
                                                      Micros delay);

} // namespace scanloom::load
