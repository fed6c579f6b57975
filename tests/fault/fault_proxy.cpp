#include "tests/fault/fault_proxy.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include <array>
#include <utility>

namespace scanloom::fault {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace asio::experimental::awaitable_operators;

namespace {

asio::awaitable<void> pause_for(tcp::socket& socket, std::chrono::microseconds time) {
    if (time.count() == 0) co_return;
    asio::steady_timer timer(socket.get_executor(), time);
    co_await timer.async_wait(kAwaitTuple);
}

/// Forwards one direction until it ends. @return how it ended
asio::awaitable<Ending> forward(tcp::socket& from, tcp::socket& to, SpoiledStream& stream) {
    std::array<char, 4096> bytes{};
    for (;;) {
        const auto [failed, count] = co_await from.async_read_some(asio::buffer(bytes), kAwaitTuple);
        if (failed) co_return Ending::kClosed;
        for (const Piece& piece : stream.take({bytes.data(), count})) {
            co_await pause_for(to, piece.pause);
            const auto [broken, written] = co_await asio::async_write(to, asio::buffer(piece.bytes), kAwaitTuple);
            if (broken) co_return Ending::kClosed;
        }
        if (stream.ending() != Ending::kNone) co_return stream.ending();
    }
}

void end(tcp::socket& socket, Ending how) {
    boost::system::error_code ignored;
    if (how == Ending::kReset) socket.set_option(asio::socket_base::linger(true, 0), ignored);
    socket.close(ignored);
}

} // namespace

FaultProxy::FaultProxy(std::uint16_t to, std::function<LinkFate(std::uint64_t)> fate_of)
    : acceptor_(io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0)), to_(asio::ip::address_v4::loopback(), to),
      fate_of_(std::move(fate_of)) {
    asio::co_spawn(io_, accept(), asio::detached);
    thread_ = std::thread([this] { io_.run(); });
}

FaultProxy::~FaultProxy() {
    io_.stop();
    thread_.join();
}

asio::awaitable<void> FaultProxy::accept() {
    for (std::uint64_t connection = 0;; ++connection) {
        auto [failed, socket] = co_await acceptor_.async_accept(kAwaitTuple);
        if (failed) co_return;
        asio::co_spawn(io_, serve(std::move(socket), fate_of_(connection)), asio::detached);
    }
}

asio::awaitable<void> FaultProxy::serve(tcp::socket near, LinkFate fate) {
    tcp::socket far(io_);
    const auto [refused] = co_await far.async_connect(to_, kAwaitTuple);
    if (refused) co_return;
    boost::system::error_code ignored; // small pieces must stay separate
    near.set_option(tcp::no_delay(true), ignored);
    far.set_option(tcp::no_delay(true), ignored);
    const auto ended = co_await (forward(near, far, fate.there) || forward(far, near, fate.back));
    const Ending how = std::visit([](Ending ending) { return ending; }, ended);
    end(near, how);
    end(far, how);
}

} // namespace scanloom::fault
