#pragma once

#include "server/http/server.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/unit/server/http/test_api.hpp"

#include <boost/asio/thread_pool.hpp>

#include <array>
#include <future>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::live {

/// Sees all around in so many directions that a few hundred events fill what lies between two sockets.
inline Sensor wide_laser() {
    Sensor sensor = testing_support::small_laser();
    sensor.angles = UniformAngles{-std::numbers::pi, std::numbers::pi / 720, 1440};
    return sensor;
}

inline Scan wide_scan(std::uint64_t seq) {
    Scan scan = testing_support::random_scan(7, seq);
    std::mt19937 random(static_cast<unsigned>(seq));
    scan.ranges.clear();
    for (int beam = 0; beam < 1440; ++beam) scan.ranges.push_back(static_cast<RangeMm>(500 + random() % 3000));
    return scan;
}

/// A robot's link that waits for its acks.
class StreamingRobot final : public sessions::RobotListener, public std::enable_shared_from_this<StreamingRobot> {
public:
    void join(sessions::Session& session, const std::string& name) {
        std::promise<void> joined;
        session.join({name}, shared_from_this(), [&joined](const Result<sessions::Joined>&) { joined.set_value(); });
        joined.get_future().wait();
    }

    /// Returns when the scan is durable and in the maps.
    void stream(sessions::Session& session, Scan scan) {
        std::promise<void> acked;
        acked_ = &acked;
        session.submit(shared_from_this(), {std::move(scan)}, 1);
        acked.get_future().wait();
    }

    void on_durable(std::uint64_t, std::size_t bytes) override {
        if (bytes > 0) acked_->set_value();
    }
    void on_failed(const Error&) override {}

private:
    std::promise<void>* acked_ = nullptr;
};

/// Sessions in memory, behind the HTTP server: real sockets on the loopback, real threads.
class LiveServer {
public:
    explicit LiveServer(const LiveConfig& live = {.interval = std::chrono::milliseconds(0)},
                        std::shared_ptr<const sockets::PortTls> tls = nullptr) {
        api_.set_recovered();
        create("lab");
        http::ServerConfig config;
        config.endpoint = {boost::asio::ip::address_v4::loopback(), 0};
        config.live = live;
        config.tls = std::move(tls);
        config.drain = std::chrono::hours(1); // so that viewers end by themselves
        server_ = http::Server::listen(io_, api_.api(), config, metrics_.http()).value();
        server_->start();
        for (auto& thread : threads_) thread = std::thread([this] { io_.run(); });
    }

    ~LiveServer() {
        sessions_.drain();
        stop();
        for (auto& thread : threads_) thread.join();
        replay_jobs_.stop();
        showing_.join();
        pool_.join();
        compute_.join();
    }

    /// Returns when the last connection is closed.
    void stop() {
        if (!server_) return;
        std::promise<void> done;
        server_->stop([&done] { done.set_value(); });
        done.get_future().wait();
        server_.reset();
    }

    void create(const std::string& name) { sessions_.create(name, {}).value(); }

    /// Scans of robot `name`, by number, each when the last is acknowledged.
    void stream(const std::string& name, std::uint64_t first, std::uint64_t last) {
        const auto session = sessions_.find("lab");
        auto& robot = robots_[name];
        if (!robot) {
            robot = std::make_shared<StreamingRobot>();
            robot->join(*session, name);
            session->submit(robot, wide_laser(), 0);
        }
        for (auto seq = first; seq <= last; ++seq) robot->stream(*session, wide_scan(seq));
    }

    void leave(const std::string& name) { sessions_.find("lab")->leave(robots_.at(name)); }

    [[nodiscard]] sessions::SessionRegistry& sessions() { return sessions_; }
    [[nodiscard]] sessions::Session& session() { return *sessions_.find("lab"); }
    [[nodiscard]] store::ScanLog& log() { return log_; }
    [[nodiscard]] guidance::RobotPaths& paths() { return goals_.paths(); }
    [[nodiscard]] auth::Authenticator& authenticator() { return authenticator_; }
    [[nodiscard]] const auth::RefusalCounters& refusals() { return audit_.counters(); }
    [[nodiscard]] metrics::LiveCounters& counters() { return metrics_.http().live; }
    [[nodiscard]] std::uint16_t port() const { return server_->port(); }

private:
    [[nodiscard]] http::Executors executors() {
        const auto pool = pool_.get_executor();
        return {.metrics = pool,
                .queries = pool,
                .whole_maps = pool,
                .log_reading = pool,
                .log_export = pool,
                .planning = pool,
                .store = pool,
                .live = showing_.get_executor()};
    }

    boost::asio::thread_pool compute_{2};
    boost::asio::thread_pool pool_{2};
    boost::asio::thread_pool showing_{1};
    store::MemoryScanLog log_;
    metrics::Metrics metrics_{"test"};
    boost::asio::io_context io_;
    sessions::SessionRegistry sessions_{log_, {compute_.get_executor(), [] { return 1'000.0; }}};
    sessions::ReplayJobs replay_jobs_{log_, compute_.get_executor()};
    guidance::GoalAssignments goals_;
    auth::Authenticator authenticator_;
    auth::AuditLog audit_{metrics_.registry()};
    auth::LoginSessions logins_;
    http::TestApi api_{sessions_, replay_jobs_, goals_,     log_, metrics_, {authenticator_, audit_, logins_},
                       {},        {},           executors()};
    std::shared_ptr<http::Server> server_;
    std::array<std::thread, 2> threads_;
    std::map<std::string, std::shared_ptr<StreamingRobot>> robots_;
};

} // namespace scanloom::live
