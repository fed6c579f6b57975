#pragma once

#include "tests/support/running_server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>

#include <sys/socket.h>

#include <cstdint>
#include <functional>
#include <string>
#include <thread>

namespace scanloom::test {

/// An HTTP proxy that changes the server's answers. Handles one connection at a time, on its own thread.
class FalsifyingProxy {
public:
    /// Converts the body of an answer to a GET to another one.
    using Lie = std::function<std::string(const std::string& target, std::string body)>;

    FalsifyingProxy(std::uint16_t to, Lie lie)
        : to_(to), lie_(std::move(lie)), acceptor_(io_, {boost::asio::ip::address_v4::loopback(), 0}),
          port_(acceptor_.local_endpoint().port()), thread_([this] { serve(); }) {}

    ~FalsifyingProxy() {
        ::shutdown(acceptor_.native_handle(), SHUT_RDWR); // wakes the thread in accept()
        thread_.join();
    }
    FalsifyingProxy(const FalsifyingProxy&) = delete;
    FalsifyingProxy& operator=(const FalsifyingProxy&) = delete;

    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

private:
    void serve() {
        for (;;) {
            boost::system::error_code failed;
            auto socket = acceptor_.accept(failed);
            if (failed) return;
            boost::beast::flat_buffer buffer;
            while (answer_one(socket, buffer)) {
            }
        }
    }

    bool answer_one(boost::asio::ip::tcp::socket& socket, boost::beast::flat_buffer& buffer) {
        namespace http = boost::beast::http;
        boost::system::error_code failed;
        http::request<http::string_body> request;
        http::read(socket, buffer, request, failed);
        if (failed) return false;
        const std::string target(request.target());
        const auto truth = http_request(to_, std::string(request.method_string()), target);
        http::response<http::string_body> response(http::int_to_status(truth.status), 11);
        response.body() = request.method() == http::verb::get ? lie_(target, truth.body) : truth.body;
        response.prepare_payload();
        http::write(socket, response, failed);
        return !failed;
    }

    std::uint16_t to_;
    Lie lie_;
    boost::asio::io_context io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_;
    std::thread thread_;
};

} // namespace scanloom::test
