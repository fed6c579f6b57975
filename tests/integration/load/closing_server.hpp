#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <thread>

namespace scanloom::test {

/// Closes each connection after its first bytes, without an answer. Runs on its own thread.
class ClosingServer {
public:
    ClosingServer() : thread_([this] { serve(); }) {}
    ~ClosingServer() {
        ::shutdown(acceptor_.native_handle(), SHUT_RDWR); // wakes the thread in accept()
        thread_.join();
    }
    ClosingServer(const ClosingServer&) = delete;
    ClosingServer& operator=(const ClosingServer&) = delete;

    [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

private:
    void serve() {
        for (;;) {
            boost::system::error_code failed;
            auto socket = acceptor_.accept(failed);
            if (failed) return;
            std::array<char, 4096> said;
            socket.read_some(boost::asio::buffer(said), failed);
        }
    }

    boost::asio::io_context io_;
    boost::asio::ip::tcp::acceptor acceptor_{io_, {boost::asio::ip::address_v4::loopback(), 0}};
    std::thread thread_;
};

} // namespace scanloom::test
