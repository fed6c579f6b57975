#pragma once

#include "common/net/connect.hpp"
#include "common/net/server_list.hpp"
#include "load/core/fault_schedule.hpp"
#include "load/core/measured_client.hpp"
#include "load/net/run_clock.hpp"
#include "robot_client/uplink/backoff.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <memory>
#include <string>
#include <vector>

namespace scanloom::load {

/// Address and credentials of all robots. Constant during a run.
struct RobotLinkOptions {
    std::vector<net::Address> servers;
    std::vector<net::Endpoints> endpoints; ///< of each of `servers`
    net::TlsContext tls;                   ///< null: links are not encrypted
    wire::Hello hello;                     ///< without session and robot name
};

/// Errors of robots, in sentences.
struct Troubles {
    static constexpr std::size_t kKept = 5;

    std::vector<std::string> failures; ///< why robots gave up; the first kKept
    std::string newest;                ///< why a link was last lost, injected faults excluded; empty: never

    void add(const Troubles& other);
};

/// One of many robots, on one link after another. It costs a socket, a small buffer and the stack of one coroutine.
///
/// Threads: all on its io_context, which one thread runs. The context must have stopped for good before this object is
///          destroyed.
class Robot {
public:
    /// State shared by the robots of one thread.
    struct Shared {
        boost::asio::io_context& io;
        const RunClock& clock;
        const Workload& workload;
        const RobotLinkOptions& link;
        FleetFigures& figures;
        Troubles& troubles;
    };

    Robot(RobotPlan plan, Shared shared);
    Robot(const Robot&) = delete;
    Robot& operator=(const Robot&) = delete;

    /// Connects, and reconnects whenever the link is lost, until everything is acknowledged.
    void start();

    void begin(Micros start) noexcept { client_.begin(start); }
    /// Sets the number of scans to send, and sends what the credit allows.
    void due(std::uint64_t scans);
    /// No more scans follow.
    void end();
    /// Keeps the link alive and detects when it is dead; call it about once a second.
    void look_after(Micros now);
    /// Injects a fault.
    /// @return false if there is no link that could fail
    bool strike(Fault fault);
    /// Closes all connections. Nothing happens afterwards.
    void stop();

    [[nodiscard]] const MeasuredClient& client() const noexcept { return client_; }
    [[nodiscard]] bool has_failed() const noexcept { return failed_; }

private:
    struct Link;

    [[nodiscard]] boost::asio::awaitable<void> run();
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> use_one_link();
    [[nodiscard]] boost::asio::awaitable<wire::LinkError> read_frames(std::shared_ptr<Link> link);
    [[nodiscard]] wire::LinkError ended(const Link& link, const boost::system::error_code& why) const;
    [[nodiscard]] std::optional<wire::LinkError> take(Link& link, std::size_t bytes);
    void flush();
    void close_link();
    void note(const wire::LinkError& failure);

    Shared shared_;
    MeasuredClient client_;
    net::ServerList servers_;
    robot::Backoff backoff_;
    std::shared_ptr<Link> link_;
    std::shared_ptr<Link> abandoned_; // half-open
    boost::asio::steady_timer timer_; // for pauses between links, or a stall
    Micros stalled_until_ = 0;
    bool struck_ = false; // the link ends by an injected fault
    bool stopped_ = false;
    bool failed_ = false;
};

} // namespace scanloom::load
