#include "server/sockets/listening_port.hpp"

#include <boost/asio/co_spawn.hpp>
#include <gtest/gtest.h>

#include <exception>
#include <new>

namespace scanloom::sockets {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

TEST(AcceptEach, LosesOneConnectionPerFailure) {
    asio::io_context io;
    tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
    tcp::socket first(io);
    tcp::socket second(io);
    first.connect(acceptor.local_endpoint());
    second.connect(acceptor.local_endpoint());

    int taken = 0;
    bool ended = false;
    const auto take = [&](tcp::socket) {
        if (++taken == 1) throw std::bad_alloc();
        acceptor.close();
    };
    asio::co_spawn(io, accept_each(acceptor, io, "a test", take), [&](std::exception_ptr failed) {
        ended = true;
        EXPECT_FALSE(failed);
    });
    io.run();
    EXPECT_EQ(taken, 2);
    EXPECT_TRUE(ended);
}

TEST(AcceptEach, EndsWhenTheAcceptorIsClosed) {
    asio::io_context io;
    tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
    bool ended = false;
    asio::co_spawn(io, accept_each(acceptor, io, "a test", [](tcp::socket) {}), [&](std::exception_ptr failed) {
        ended = true;
        EXPECT_FALSE(failed);
    });
    io.poll();
    acceptor.close();
    io.run();
    EXPECT_TRUE(ended);
}

} // namespace
} // namespace scanloom::sockets
