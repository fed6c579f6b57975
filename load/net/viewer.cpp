#include "common/net/await_tuple.hpp"
#include "common/net/websocket_teardown.hpp"
#include "load/net/http_connection.hpp"
#include "load/net/onlooker.hpp"
#include "load/net/open_link.hpp"

#include <boost/asio/error.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
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
    boost::system::error_code failed;
    std::string refusal; ///< the server's answer if it refused; otherwise empty
};

asio::awaitable<Entry> enter(Stream& stream, const OnlookerShared& shared, std::string session) {
    const auto& server = shared.http.server;
    const auto unlinked = co_await open_link(stream.next_layer(), shared.http);
    if (unlinked) co_return Entry{unlinked, {}};
    const auto host = fmt::format("{}:{}", server.host, server.port);
    const auto target = fmt::format("/api/v1/sessions/{}/live", session);
    if (const auto authorization = authorization_of(shared.http.token); !authorization.empty()) {
        stream.set_option(beast::websocket::stream_base::decorator(
            [authorization](auto& request) { request.set(beast::http::field::authorization, authorization); }));
    }
    beast::websocket::response_type answer;
    const auto [failed] = co_await stream.async_handshake(answer, host, target, kAwaitTuple);
    if (failed != beast::websocket::error::upgrade_declined) co_return Entry{failed, {}};
    co_return Entry{failed, refusal({answer.result_int(), {}, answer.body()}, target).message};
}

/// A session without changes sends no events, so only the admission has a time limit.
asio::awaitable<Entry> enter_in_time(Stream& stream, const OnlookerShared& shared, std::string session) {
    using namespace asio::experimental::awaitable_operators;
    asio::steady_timer timer(stream.get_executor());
    timer.expires_after(kEnterMax);
    auto first = co_await (enter(stream, shared, std::move(session)) || timer.async_wait(kAwaitTuple));
    if (first.index() != 0) co_return Entry{asio::error::timed_out, {}};
    co_return std::get<0>(std::move(first));
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
        Stream stream(link_to(shared.http, executor));
        Entry entry = co_await enter_in_time(stream, shared, session);
        const bool watches = !entry.failed;
        if (watches) {
            standing.let_in();
            ++figures.watching;
            entry.failed = co_await take_events(stream, figures);
            --figures.watching;
        }
        if (shared.stopped) co_return;
        if (watches) ++figures.viewer_ends;
        if (!entry.refusal.empty()) standing.refused();
        figures.trouble =
            fmt::format("a viewer of session {}: {}", session,
                        entry.refusal.empty() ? trouble_with(stream.next_layer(), entry.failed) : entry.refusal);
        pause.expires_after(kPause);
        co_await pause.async_wait(kAwaitTuple);
    }
}

} // namespace scanloom::load
