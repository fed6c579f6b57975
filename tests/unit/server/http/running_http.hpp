#pragma once

#include "server/http/server.hpp"
#include "tests/support/http_client.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/unit/server/http/test_api.hpp"

#include <boost/asio/thread_pool.hpp>
#include <fmt/format.h>

#include <array>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace scanloom::http {

/// Responds with the request; throws on request.
inline Response echo(const Request& request) {
    if (request.target == "/throw") throw std::runtime_error("asked to");
    return ok("text/plain", Body(request.method + " " + request.target + " " + request.body));
}

inline Result<Response> ask_test(Context& context) {
    return static_cast<TestServices&>(context.services).answer(context.request);
}

/// The routes of the server and some more, all with the test's handler.
inline std::vector<Route> echoing_routes() {
    std::vector<Route> echoing;
    for (const auto& route : routes()) {
        echoing.push_back({route.method, route.path, route.name, route.access, route.work, Sessions::kUnused,
                           kAnyParameters, ask_test});
    }
    for (const auto method : {Method::kGet, Method::kPost}) {
        for (const auto* path : {"/", "/{a}", "/{a}/{b}"}) {
            echoing.push_back(
                {method, path, "echo", Access::kOpen, WorkClass::kIo, Sessions::kUnused, kAnyParameters, ask_test});
        }
    }
    return echoing;
}

/// An http::Server on two threads, with a thread for each executor.
class RunningHttp {
public:
    explicit RunningHttp(ServerConfig config = {}, Answer answer = echo)
        : api_(sessions_, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {}, config, executors(),
               routes_) {
        api_.services().answer = std::move(answer);
        config.endpoint = {boost::asio::ip::address_v4::loopback(), 0};
        server_ = Server::listen(io_, api_.api(), config, counters()).value();
        server_->start();
        for (auto& thread : threads_) thread = std::thread([this] { io_.run(); });
    }

    ~RunningHttp() {
        stop();
        for (auto& thread : threads_) thread.join();
    }

    void stop() {
        if (stopped_) return;
        stopped_ = true;
        std::promise<void> done;
        server_->stop([&done] { done.set_value(); });
        done.get_future().wait();
    }

    /// For tests that stop the server themselves.
    void set_stopped() { stopped_ = true; }

    [[nodiscard]] std::uint16_t port() const { return server_->port(); }
    [[nodiscard]] Server& server() { return *server_; }
    [[nodiscard]] boost::asio::io_context& io() { return io_; }
    [[nodiscard]] const Api& api() const { return api_.api(); }
    [[nodiscard]] metrics::HttpCounters& counters() { return metrics_.http(); }
    [[nodiscard]] double refusals(auth::Reason reason) {
        return audit_.counters().of(auth::Port::kHttp, reason).Value();
    }

private:
    [[nodiscard]] Executors executors() {
        return {.metrics = pools_[0].get_executor(),
                .queries = pools_[1].get_executor(),
                .whole_maps = pools_[2].get_executor(),
                .log_reading = pools_[3].get_executor(),
                .log_export = pools_[4].get_executor(),
                .planning = pools_[5].get_executor(),
                .store = pools_[6].get_executor(),
                .live = pools_[7].get_executor()};
    }

    std::array<boost::asio::thread_pool, 8> pools_{boost::asio::thread_pool(1), boost::asio::thread_pool(1),
                                                   boost::asio::thread_pool(1), boost::asio::thread_pool(1),
                                                   boost::asio::thread_pool(1), boost::asio::thread_pool(1),
                                                   boost::asio::thread_pool(1), boost::asio::thread_pool(1)};
    boost::asio::io_context io_;
    store::MemoryScanLog log_;
    metrics::Metrics metrics_{"test"};
    sessions::SessionRegistry sessions_{log_, {pools_[0].get_executor(), [] { return 0.0; }}};
    sessions::ReplayJobs weaves_{log_, pools_[0].get_executor()};
    guidance::GoalAssignments goals_;
    auth::Authenticator authenticator_;
    auth::AuditLog audit_{metrics_.registry()};
    auth::LoginSessions logins_;
    std::vector<Route> routes_ = echoing_routes();
    TestApi api_;
    std::shared_ptr<Server> server_;
    std::array<std::thread, 2> threads_;
    bool stopped_ = false;
};

inline std::string get(std::string_view target) {
    return fmt::format("GET {} HTTP/1.1\r\nHost: localhost\r\n\r\n", target);
}

/// Sends bytes on a connection of their own and reads one answer.
inline testing_support::HttpAnswer answer_to(RunningHttp& server, std::string_view bytes) {
    testing_support::HttpClient client(server.port());
    client.send(bytes);
    return client.read();
}

} // namespace scanloom::http
