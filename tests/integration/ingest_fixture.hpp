#pragma once

#include "server/ingest/ingest_server.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/robot_socket.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::ingest {

using testing_support::frame_of;
using testing_support::random_scan;
using testing_support::random_scans;
using testing_support::RobotSocket;
using testing_support::small_laser;

/// The ingest half of the server in this process: real sockets on the loopback, real threads.
class RunningIngest {
public:
    explicit RunningIngest(store::ScanLog& log, const IngestConfig& config = {},
                           std::size_t requests_max = RequestDesk::kRequestsMax)
        : sessions_(log, pool(), now), desk_(planning_.get_executor(), goals_, sessions_, requests_max) {
        if (auto recovered = sessions_.recover(); !recovered) throw ErrorException(recovered.error());
        server_ = std::make_unique<IngestServer>(
            io_, boost::asio::ip::tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0),
            LinkServices{sessions_, may_wait_.get_executor(), metrics_.ingest(), desk_, gate_, audit_}, config);
        server_->start();
        for (int n = 0; n < 2; ++n) io_threads_.emplace_back([this] { io_.run(); });
    }

    RunningIngest(const RunningIngest&) = delete;
    RunningIngest& operator=(const RunningIngest&) = delete;

    /// Returns when every link has ended and every scan is durable. Links that were never told to end
    /// hang here: that is a fault.
    ~RunningIngest() {
        server_->stop();
        sessions_.drain();
        for (auto& thread : io_threads_) thread.join();
        planning_.join();
        may_wait_.join();
        compute_.join();
    }

    void stop_accepting() { server_->stop(); }
    [[nodiscard]] session::SessionRegistry& sessions() { return sessions_; }
    [[nodiscard]] metrics::IngestCounters& counters() { return metrics_.ingest(); }
    [[nodiscard]] metrics::RefusalCounters& refusals() { return metrics_.refusals(); }
    [[nodiscard]] guard::Gate& gate() { return gate_; }
    [[nodiscard]] guide::GoalBook& goals() { return goals_; }
    [[nodiscard]] boost::asio::any_io_executor planning() { return planning_.get_executor(); }
    [[nodiscard]] boost::asio::any_io_executor may_wait() { return may_wait_.get_executor(); }
    [[nodiscard]] std::uint16_t port() const { return server_->port(); }

    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> snapshot(const std::string& session) {
        return sessions_.find(session)->snapshot();
    }
    [[nodiscard]] std::string digest(const std::string& session) {
        return testing_support::digests_of(*snapshot(session));
    }

private:
    static double now() { return 1'000.0; }
    boost::asio::any_io_executor pool() { return compute_.get_executor(); }

    boost::asio::thread_pool compute_{2};
    metrics::Metrics metrics_{"test"};
    guard::Gate gate_;
    guard::Audit audit_{metrics_.refusals()};
    boost::asio::thread_pool may_wait_{2};
    boost::asio::thread_pool planning_{1};
    boost::asio::io_context io_;
    session::SessionRegistry sessions_;
    guide::GoalBook goals_;
    RequestDesk desk_;
    std::unique_ptr<IngestServer> server_;
    std::vector<std::thread> io_threads_;
};

inline wire::Hello hello(const std::string& robot, const std::string& session = "lab") {
    wire::Hello hello;
    hello.robot = robot;
    hello.session = session;
    hello.create = SessionOptions{};
    hello.client = "ingest test";
    return hello;
}

/// A robot that has been welcomed.
inline std::unique_ptr<RobotSocket> welcomed(std::uint16_t port, const wire::Hello& hello) {
    auto robot = std::make_unique<RobotSocket>(port);
    robot->send(hello);
    robot->receive_kind<wire::Welcome>();
    return robot;
}

/// Sends the scans first..last of the seed's stream, in batches of ten, and waits until they are durable.
inline void stream(RobotSocket& robot, unsigned seed, std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t seq = first; seq <= last; seq += 10) {
        robot.send(wire::ScanBatch{random_scans(seed, seq, std::min<std::uint64_t>(10, last + 1 - seq))});
    }
    robot.wait_for_ack(last);
}

/// Waits for the error that ends the link, and for the server's hanging up after it.
inline wire::LinkError farewell_to(RobotSocket& robot) {
    for (;;) {
        const auto message = robot.receive();
        if (!message) throw std::runtime_error("the server hung up without a word");
        if (const auto* error = std::get_if<wire::LinkError>(&*message)) {
            EXPECT_FALSE(robot.receive().has_value()) << "the error is the last frame";
            return *error;
        }
    }
}

inline void expect_refused(RobotSocket& robot, Errc code, bool retryable, const std::string& beginning) {
    const auto refused = farewell_to(robot);
    EXPECT_EQ(refused.error.code, code) << refused.error.message;
    EXPECT_EQ(refused.retryable, retryable) << refused.error.message;
    EXPECT_THAT(refused.error.message, testing::StartsWith(beginning));
}

class IngestTest : public testing::Test {
protected:
    RunningIngest& start(const IngestConfig& config = {}) {
        running_ = std::make_unique<RunningIngest>(log_, config);
        return *running_;
    }
    [[nodiscard]] std::uint16_t port() const { return running_->port(); }

    store::MemoryScanLog log_;
    std::unique_ptr<RunningIngest> running_;
};

} // namespace scanloom::ingest
