#include "load/net/audience.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace scanloom::load {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;

/// The figures of one viewer, and a server that refuses it, then accepts it, sends one event, disconnects, and then
/// refuses it again. All run on one thread.
class Viewer : public testing::Test {
protected:
    asio::awaitable<tcp::socket> refuse() {
        auto socket = co_await acceptor_.async_accept(asio::use_awaitable);
        boost::beast::flat_buffer buffer;
        http::request<http::empty_body> request;
        co_await http::async_read(socket, buffer, request, asio::use_awaitable);
        target_ = request.target();
        http::response<http::string_body> answer(http::status::service_unavailable, 11);
        answer.body() = "512 watch already";
        answer.prepare_payload();
        co_await http::async_write(socket, answer, asio::use_awaitable);
        co_return socket; // open until the viewer's next request: by then it has read the answer
    }

    asio::awaitable<void> send_one_event() {
        websocket::stream<tcp::socket> viewer(co_await acceptor_.async_accept(asio::use_awaitable));
        co_await viewer.async_accept(asio::use_awaitable);
        viewer.binary(true);
        co_await viewer.async_write(asio::buffer(std::string("event")), asio::use_awaitable);
        co_await viewer.async_close(websocket::close_code::going_away, asio::use_awaitable);
    }

    asio::awaitable<void> serve() {
        const auto first = co_await refuse();
        auto next = co_await acceptor_.async_accept(asio::use_awaitable); // the viewer has read the answer
        after_refusal_ = figures_;
        next.close();
        co_await send_one_event();
        const auto last = co_await refuse();
        co_await acceptor_.async_accept(asio::use_awaitable);
        io_.stop();
    }

    asio::io_context io_{1};
    tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}};
    RunClock clock_;
    AudienceFigures figures_;
    AudienceFigures after_refusal_;
    AudienceShared shared_{
        clock_, {{"127.0.0.1", std::to_string(acceptor_.local_endpoint().port())}, nullptr, ""}, figures_};
    std::string target_;
};

TEST_F(Viewer, CountsAsRefusedUntilItIsAccepted) {
    asio::co_spawn(io_, serve(), asio::detached);
    asio::co_spawn(io_, watch(shared_, "lab"), asio::detached);
    io_.run();
    EXPECT_EQ(target_, "/api/v1/sessions/lab/live");
    EXPECT_EQ(after_refusal_.viewers_refused, 1U);
    EXPECT_EQ(after_refusal_.viewers_let_in, 0U);
    EXPECT_EQ(after_refusal_.viewer_ends, 0U) << "the viewer has not started to watch";
    EXPECT_THAT(after_refusal_.trouble, testing::HasSubstr("a viewer of session lab: "));
    EXPECT_THAT(after_refusal_.trouble, testing::HasSubstr("503: 512 watch already"));
    EXPECT_EQ(figures_.viewers_refused, 0U);
    EXPECT_EQ(figures_.viewers_let_in, 1U);
    EXPECT_EQ(figures_.events, 1U);
    EXPECT_EQ(figures_.event_bytes, 5U);
    EXPECT_EQ(figures_.viewer_ends, 1U);
    EXPECT_EQ(figures_.watching, 0U);
}

} // namespace
} // namespace scanloom::load
