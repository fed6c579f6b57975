#pragma once

#include "load/core/audience_figures.hpp"
#include "load/net/onlooker.hpp"
#include "load/net/run_clock.hpp"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::load {

struct AudiencePlan {
    std::uint32_t viewers = 0;
    std::uint32_t tile_readers = 0;
    double tile_rate = 0.0; ///< requests per second of each reader
    HttpPlace http;
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
    OnlookerShared shared_;
    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    std::thread thread_;
};

} // namespace scanloom::load
