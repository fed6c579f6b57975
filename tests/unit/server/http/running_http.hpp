#pragma once

#include "server/http/server.hpp"

#include "tests/support/http_client.hpp"

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

namespace scanloom::http {

/// Says what it was asked; fails when asked to.
inline Response echo(const Request& request) {
    if (request.target == "/throw") throw std::runtime_error("asked to");
    return ok("text/plain", Body(request.method + " " + request.target + " " + request.body));
}

/// An http::Server on two threads, with threads of its own for each lane.
class RunningHttp {
public:
    explicit RunningHttp(ServerConfig config = {}, Answer answer = echo)
        : RunningHttp(std::move(config), Answering{std::move(answer)}) {}
    RunningHttp(ServerConfig config, Answering answering) {
        config.endpoint = {boost::asio::ip::address_v4::loopback(), 0};
        server_ = Server::listen(io_, executors(), config, std::move(answering), counters_).value();
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
    [[nodiscard]] Executors executors() {
        return {.telling = telling_.get_executor(),
                .serving = serving_.get_executor(),
                .survey = survey_.get_executor(),
                .paths = paths_.get_executor(),
                .logs = logs_.get_executor(),
                .weaving = weaving_.get_executor(),
                .planning = planning_.get_executor(),
                .changing = changing_.get_executor(),
                .showing = showing_.get_executor()};
    }
    [[nodiscard]] metrics::HttpCounters& counters() { return counters_; }

private:
    prometheus::Registry registry_;
    metrics::HttpCounters counters_{registry_};
    boost::asio::thread_pool telling_{1};
    boost::asio::thread_pool serving_{1};
    boost::asio::thread_pool survey_{1};
    boost::asio::thread_pool paths_{1};
    boost::asio::thread_pool logs_{1};
    boost::asio::thread_pool weaving_{1};
    boost::asio::thread_pool planning_{1};
    boost::asio::thread_pool changing_{1};
    boost::asio::thread_pool showing_{1};
    boost::asio::io_context io_;
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
