#pragma once

#include "common/net/http_connection.hpp"
#include "load/core/figures.hpp"
#include "load/net/run_clock.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::load {

/// State shared by the viewers and tile readers of one thread.
struct AudienceShared {
    const RunClock& clock;
    net::HttpPlace http;
    AudienceFigures& figures;
    bool stopped = false; ///< every reader and viewer ends once it is set
};

/// Watches a session over a WebSocket as the viewer's page does: all layers and points, reading every event
/// immediately. Reconnects a second after a connection ended or was refused. `shared` must live until the executor has
/// stopped.
[[nodiscard]] boost::asio::awaitable<void> watch(AudienceShared& shared, std::string session);

/// Fetches the tiles of a session one after the other, again and again, `rate` per second, each with its last ETag, as
/// a browser does. Starts after `delay`, so that readers do not send requests in step.
[[nodiscard]] boost::asio::awaitable<void> read_tiles(AudienceShared& shared, std::string session, double rate,
                                                      Micros delay);

struct AudiencePlan {
    std::uint32_t viewers = 0;
    std::uint32_t tile_readers = 0;
    double tile_rate = 0.0; ///< requests per second of each reader
    net::HttpPlace http;
    std::vector<std::string> sessions; ///< the first viewer watches the first, and so on, cyclically
};

/// Viewers and tile readers on their own thread, so that they do not delay the robots.
///
/// Threads: begin() and look() may be called from any.
class Audience {
public:
    Audience(const AudiencePlan& plan, const RunClock& clock);
    ~Audience();
    Audience(const Audience&) = delete;
    Audience& operator=(const Audience&) = delete;

    void begin();
    /// Returns the current statistics; waits for the audience's thread.
    [[nodiscard]] std::unique_ptr<AudienceFigures> look();
    void stop();

private:
    AudiencePlan plan_;
    AudienceFigures figures_;
    AudienceShared shared_;
    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    std::thread thread_;
};

} // namespace scanloom::load
