#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <thread>

namespace scanloom::test {

/// Hangs up on whoever has said something, without a word. On a thread of its own.
class HangingUp {
public:
    HangingUp() : thread_([this] { serve(); }) {}
    ~HangingUp() {
        ::shutdown(acceptor_.native_handle(), SHUT_RDWR); // whoever waits in accept() is told
        thread_.join();
    }
    HangingUp(const HangingUp&) = delete;
    HangingUp& operator=(const HangingUp&) = delete;

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
