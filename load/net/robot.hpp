#pragma once

#include "common/net/link_stream.hpp"
#include "common/net/tls.hpp"
#include "common/wire/frame_decoder.hpp"
#include "load/core/fault_schedule.hpp"
#include "load/core/robot_talk.hpp"
#include "load/net/run_clock.hpp"
#include "robot_client/uplink/backoff.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include <memory>
#include <string>
#include <vector>

namespace scanloom::load {

/// Where and as whom all robots connect. Never changes while they run.
struct RobotLinkOptions {
    std::vector<boost::asio::ip::tcp::endpoint> server;
    std::string host;    ///< as the server's certificate has it
    net::TlsContext tls; ///< null: links are not encrypted
    wire::Hello hello;   ///< without the names of session and robot
};

/// What went wrong with robots, in sentences.
struct Troubles {
    static constexpr std::size_t kKept = 5;

    std::vector<std::string> failures; ///< why robots gave up: the first kKept
    std::string newest;                ///< why a link was lost that no fault of ours had struck; empty: none was

    void add(const Troubles& other);
};

/// A robot of many on its links, one after the other. It costs a socket, a small buffer and the stack of one coroutine.
///
/// Thread  all on its io_context, which one thread runs. The context has stopped for good when this is destroyed.
class Robot {
public:
    /// What the robots of one thread share.
    struct Shared {
        boost::asio::io_context& io;
        const RunClock& clock;
        const Course& course;
        const RobotLinkOptions& link;
        FleetFigures& figures;
        Troubles& troubles;
    };

    Robot(RobotPlan plan, Shared shared);
    Robot(const Robot&) = delete;
    Robot& operator=(const Robot&) = delete;

    /// Connects, and again whenever the link is lost, until everything is acknowledged.
    void start();

    void begin(Micros start) noexcept { talk_.begin(start); }
    /// So many scans are there to be sent; sends what may be.
    void due(std::uint64_t scans);
    /// There will be no more.
    void end();
    /// Keeps the link alive and notices when it is not: to be called about once a second.
    void look_after(Micros now);
    /// @return false where there is no link that could fail.
    bool strike(Fault fault);
    /// Closes what is open. No more than that will happen.
    void stop();

    [[nodiscard]] const RobotTalk& talk() const noexcept { return talk_; }
    [[nodiscard]] bool has_failed() const noexcept { return failed_; }

private:
    struct Link;

    [[nodiscard]] boost::asio::awaitable<void> run();
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> use_one_link();
    [[nodiscard]] boost::asio::awaitable<boost::system::error_code> connect(std::shared_ptr<Link> link);
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> read_frames(std::shared_ptr<Link> link);
    [[nodiscard]] std::string ended(const Link& link, const boost::system::error_code& why) const;
    [[nodiscard]] std::optional<wire::LinkError> take(Link& link, std::size_t bytes);
    void flush();
    void close_link();
    void note(const wire::LinkError& failure);

    Shared shared_;
    RobotTalk talk_;
    robot::Backoff backoff_;
    std::shared_ptr<Link> link_;
    std::shared_ptr<Link> abandoned_; // half-open
    boost::asio::steady_timer timer_; // of a pause between links, or of a stall
    Micros stalled_until_ = 0;
    bool struck_ = false; // the link ends by a fault of ours
    bool stopped_ = false;
    bool failed_ = false;
};

} // namespace scanloom::load
