#include "load/net/onlooker.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <fmt/format.h>

namespace scanloom::load {

namespace asio = boost::asio;
namespace beast = boost::beast;

namespace {

constexpr auto kUse = asio::as_tuple(asio::use_awaitable);
constexpr std::chrono::seconds kConnectMax{10};
constexpr std::chrono::seconds kPause{1};
constexpr std::size_t kEventMax = std::size_t{1} << 20; ///< bytes; the server's are at most 512 KiB

using Stream = beast::websocket::stream<beast::tcp_stream>;

asio::awaitable<boost::system::error_code> connect(Stream& stream, const robot::ServerAddress& server,
                                                   std::string session) {
    asio::ip::tcp::resolver resolver(stream.get_executor());
    const auto [unresolved, addresses] = co_await resolver.async_resolve(server.host, server.port, kUse);
    if (unresolved) co_return unresolved;
    auto& tcp = beast::get_lowest_layer(stream);
    tcp.expires_after(kConnectMax);
    const auto [refused, endpoint] = co_await tcp.async_connect(addresses, kUse);
    if (refused) co_return refused;
    const auto host = fmt::format("{}:{}", server.host, server.port);
    const auto target = fmt::format("/api/v1/sessions/{}/live", session);
    const auto [failed] = co_await stream.async_handshake(host, target, kUse);
    tcp.expires_never(); // while nothing changes there are no events
    co_return failed;
}

asio::awaitable<boost::system::error_code> take_events(Stream& stream, AudienceFigures& figures) {
    beast::flat_buffer event;
    stream.read_message_max(kEventMax);
    for (;;) {
        const auto [failed, bytes] = co_await stream.async_read(event, kUse);
        if (failed) co_return failed;
        ++figures.events;
        figures.event_bytes += bytes;
        event.clear();
    }
}

} // namespace

asio::awaitable<void> watch(OnlookerShared& shared, std::string session) {
    const auto executor = co_await asio::this_coro::executor;
    asio::steady_timer pause(executor);
    while (!shared.stopped) {
        Stream stream(executor);
        boost::system::error_code failed = co_await connect(stream, shared.http, session);
        if (!failed) {
            ++shared.figures.watching;
            failed = co_await take_events(stream, shared.figures);
            --shared.figures.watching;
        }
        if (shared.stopped) co_return;
        ++shared.figures.viewer_ends;
        shared.figures.trouble = fmt::format("a viewer of session {}: {}", session, failed.message());
        pause.expires_after(kPause);
        co_await pause.async_wait(kUse);
    }
}

} // namespace scanloom::load
