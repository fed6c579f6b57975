#include "common/net/await_tuple.hpp"
#include "common/net/websocket_teardown.hpp"
#include "load/net/http_connection.hpp"
#include "load/net/onlooker.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <fmt/format.h>

namespace scanloom::load {

namespace asio = boost::asio;
namespace beast = boost::beast;

namespace {

constexpr std::chrono::seconds kEnterMax{10};
constexpr std::chrono::seconds kPause{1};
constexpr std::size_t kEventMax = std::size_t{1} << 20; ///< bytes; the server's have at most 512 KiB

using Stream = beast::websocket::stream<net::LinkStream>;

/// Result of a request to watch.
struct Entry {
    std::string trouble; ///< for people; empty: the viewer watches
    bool is_refused = false;
};

/// A session without changes sends no events, so only the admission has time limits.
asio::awaitable<Entry> enter(Stream& stream, const OnlookerShared& shared, std::string session) {
    const net::Address& server = shared.http.server;
    const auto connected = co_await net::connect(stream.next_layer(), server, kEnterMax);
    if (!connected) co_return Entry{connected.error().message};
    const auto target = fmt::format("/api/v1/sessions/{}/live", session);
    if (const auto authorization = authorization_of(shared.http.token); !authorization.empty()) {
        stream.set_option(beast::websocket::stream_base::decorator(
            [authorization](auto& request) { request.set(beast::http::field::authorization, authorization); }));
    }
    beast::websocket::response_type answer;
    const auto answered =
        co_await net::within(kEnterMax, stream.async_handshake(answer, server.text(), target, kAwaitTuple));
    if (!answered) co_return Entry{fmt::format("no answer within {} s", kEnterMax.count())};
    const auto [failed] = *answered;
    if (!failed) co_return Entry{};
    if (failed != beast::websocket::error::upgrade_declined) {
        co_return Entry{net::failure_text(stream.next_layer(), failed)};
    }
    co_return Entry{refusal({answer.result_int(), {}, answer.body()}, target).message, true};
}

asio::awaitable<boost::system::error_code> take_events(Stream& stream, AudienceFigures& figures) {
    beast::flat_buffer event;
    stream.read_message_max(kEventMax);
    for (;;) {
        const auto [failed, bytes] = co_await stream.async_read(event, kAwaitTuple);
        if (failed) co_return failed;
        ++figures.events;
        figures.event_bytes += bytes;
        event.clear();
    }
}

/// Counts a viewer once, as admitted if it ever was.
class Standing {
public:
    explicit Standing(AudienceFigures& figures) : figures_(figures) {}

    void let_in() {
        if (is_in_) return;
        is_in_ = true;
        ++figures_.viewers_let_in;
        if (is_refused_) --figures_.viewers_refused;
    }
    void refused() {
        if (is_in_ || is_refused_) return;
        is_refused_ = true;
        ++figures_.viewers_refused;
    }

private:
    AudienceFigures& figures_;
    bool is_in_ = false;
    bool is_refused_ = false;
};

} // namespace

asio::awaitable<void> watch(OnlookerShared& shared, std::string session) {
    const auto executor = co_await asio::this_coro::executor;
    asio::steady_timer pause(executor);
    AudienceFigures& figures = shared.figures;
    Standing standing(figures);
    while (!shared.stopped) {
        Stream stream(net::client_stream(executor, shared.http.tls));
        Entry entry = co_await enter(stream, shared, session);
        const bool watches = entry.trouble.empty();
        if (watches) {
            standing.let_in();
            ++figures.watching;
            const auto ended = co_await take_events(stream, figures);
            entry.trouble = net::failure_text(stream.next_layer(), ended);
            --figures.watching;
        }
        if (shared.stopped) co_return;
        if (watches) ++figures.viewer_ends;
        if (entry.is_refused) standing.refused();
        figures.trouble = fmt::format("a viewer of session {}: {}", session, entry.trouble);
        pause.expires_after(kPause);
        co_await pause.async_wait(kAwaitTuple);
    }
}

} // namespace scanloom::load
