#pragma once

#include "common/app/standard_streams.hpp"
#include "common/net/http_connection.hpp"
#include "load/app/options.hpp"
#include "load/core/live_view.hpp"
#include "load/net/audience.hpp"
#include "load/net/fleet.hpp"
#include "load/net/verification.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <memory>
#include <string>
#include <vector>

namespace scanloom::load {

/// One run from the first connection to the verdict: checks that its sessions are new, connects all robots, streams,
/// waits for the last acknowledgements, verifies, and deletes the sessions that it created.
/// Threads: that of `io`, which must not run after this object is destroyed.
class LoadRun {
public:
    /// The references must outlive this object.
    LoadRun(boost::asio::io_context& io, const LoadOptions& options, const Workload& workload,
            const RobotLinkOptions& link, const net::HttpPlace& http, Console& console);

    /// Runs everything. Call once.
    /// Errors: kAlreadyExists: there are sessions with the run's names; those of HTTP. Nothing was started then.
    [[nodiscard]] boost::asio::awaitable<Result<RunReport>> conduct();

    /// Sends no more scans; waits for what was sent and verifies it.
    void interrupt();

private:
    [[nodiscard]] boost::asio::awaitable<Result<>> make_room();
    [[nodiscard]] boost::asio::awaitable<bool> connect_robots();
    [[nodiscard]] boost::asio::awaitable<void> stream();
    [[nodiscard]] boost::asio::awaitable<void> wait_for_the_last_ack();
    [[nodiscard]] boost::asio::awaitable<void> verify();
    [[nodiscard]] boost::asio::awaitable<void> clean_up();
    [[nodiscard]] std::string why_nothing_was_sent(const std::string& trouble) const;
    [[nodiscard]] boost::asio::awaitable<Moment> moment();
    [[nodiscard]] boost::asio::awaitable<void> pause(Micros time);
    void show(const Moment& before, const Moment& now);
    [[nodiscard]] std::vector<ExpectedSession> expected() const;
    [[nodiscard]] bool needs_http() const noexcept;
    [[nodiscard]] std::string reference_name() const;

    boost::asio::io_context& io_;
    const LoadOptions& options_;
    const Workload& workload_;
    const RobotLinkOptions& link_;
    Console& console_;
    RunClock clock_;
    std::vector<std::string> sessions_;
    std::vector<RobotPlan> robots_;
    net::HttpConnection http_;
    Fleet fleet_;
    Audience audience_;
    std::unique_ptr<ReferenceSession> reference_;
    RunReport report_;
    Micros begun_ = 0;
    bool interrupted_ = false;
};

} // namespace scanloom::load
