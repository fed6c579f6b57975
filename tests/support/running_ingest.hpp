#pragma once

#include "server/ingest/ingest_server.hpp"
#include "tests/support/digests.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>

#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::ingest {

/// Runs the ingest part of the server in this process, with real loopback sockets and real threads.
class RunningIngest {
public:
    explicit RunningIngest(store::ScanLog& log, const IngestConfig& config = {},
                           std::size_t requests_max = RequestExecutor::kRequestsMax)
        : sessions_(log, {pool(), now}), locator_(log),
          requests_(planning_.get_executor(), locating_.get_executor(), {goals_, locator_, sessions_}, requests_max) {
        if (auto recovered = sessions_.recover(); !recovered) throw ErrorException(recovered.error());
        server_ = std::make_unique<IngestServer>(
            io_, boost::asio::ip::tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0),
            LinkServices{sessions_, blocking_executor_.get_executor(), metrics_.ingest(), requests_, authenticator_,
                         audit_},
            config);
        server_->start();
        for (int n = 0; n < 2; ++n) io_threads_.emplace_back([this] { io_.run(); });
    }

    RunningIngest(const RunningIngest&) = delete;
    RunningIngest& operator=(const RunningIngest&) = delete;

    /// Returns when every connection has ended and every scan is durable. Hangs if a connection does not end after the
    /// stop, which is a bug.
    ~RunningIngest() {
        server_->stop();
        sessions_.drain();
        for (auto& thread : io_threads_) thread.join();
        planning_.join();
        locating_.join();
        blocking_executor_.join();
        compute_.join();
    }

    void stop_accepting() { server_->stop(); }
    [[nodiscard]] sessions::SessionRegistry& sessions() { return sessions_; }
    [[nodiscard]] metrics::IngestCounters& counters() { return metrics_.ingest(); }
    [[nodiscard]] const auth::RefusalCounters& refusals() { return audit_.counters(); }
    [[nodiscard]] auth::Authenticator& authenticator() { return authenticator_; }
    [[nodiscard]] guidance::GoalAssignments& goals() { return goals_; }
    [[nodiscard]] guidance::Locator& locator() { return locator_; }
    [[nodiscard]] boost::asio::any_io_executor planning() { return planning_.get_executor(); }
    [[nodiscard]] boost::asio::any_io_executor locating() { return locating_.get_executor(); }
    [[nodiscard]] boost::asio::any_io_executor blocking_executor() { return blocking_executor_.get_executor(); }
    [[nodiscard]] std::uint16_t port() const { return server_->port(); }

    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> snapshot(const std::string& session) {
        return sessions_.load(session).value()->snapshot();
    }
    [[nodiscard]] std::string digest(const std::string& session) {
        return testing_support::digests_of(*snapshot(session));
    }

private:
    static double now() { return 1'000.0; }
    boost::asio::any_io_executor pool() { return compute_.get_executor(); }

    boost::asio::thread_pool compute_{2};
    metrics::Metrics metrics_{"test"};
    auth::Authenticator authenticator_;
    auth::AuditLog audit_{metrics_.registry()};
    boost::asio::thread_pool blocking_executor_{2};
    boost::asio::thread_pool planning_{1};
    boost::asio::thread_pool locating_{1};
    boost::asio::io_context io_;
    sessions::SessionRegistry sessions_;
    guidance::GoalAssignments goals_;
    guidance::Locator locator_;
    RequestExecutor requests_;
    std::unique_ptr<IngestServer> server_;
    std::vector<std::thread> io_threads_;
};

} // namespace scanloom::ingest
