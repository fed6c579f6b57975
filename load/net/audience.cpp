#include "load/net/audience.hpp"

#include "common/net/await_tuple.hpp"
#include "common/net/http_connection.hpp"
#include "common/net/web_socket.hpp"
#include "load/core/tile_tour.hpp"
#include "load/net/server_api.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <fmt/format.h>

#include <future>
#include <unordered_map>
#include <utility>
#include <vector>

namespace scanloom::load {

namespace asio = boost::asio;
namespace beast = boost::beast;

// Viewers -------------------------------------------------------------------------------------------------------------

namespace {

constexpr std::chrono::seconds kEnterMax{10};
constexpr std::chrono::seconds kPause{1};
constexpr std::size_t kEventMax = std::size_t{1} << 20; ///< bytes; the server's have at most 512 KiB

using Stream = net::WebSocket;

/// Result of a request to watch.
struct Entry {
    std::string trouble; ///< for people; empty: the viewer watches
    bool is_refused = false;
};

/// A session without changes sends no events, so only the admission has time limits.
asio::awaitable<Entry> enter(Stream& stream, const AudienceShared& shared, std::string session) {
    const net::Address& server = shared.http.server;
    const auto connected = co_await net::connect(stream.next_layer(), server, kEnterMax);
    if (!connected) co_return Entry{connected.error().message};
    const auto target = fmt::format("/api/v1/sessions/{}/live", session);
    if (const auto authorization = net::authorization_of(shared.http.token); !authorization.empty()) {
        stream.set_option(beast::websocket::stream_base::decorator(
            [authorization](auto& request) { request.set(beast::http::field::authorization, authorization); }));
    }
    beast::websocket::response_type answer;
    const std::string host = server.text();
    const auto answered = co_await net::within(kEnterMax, net::shake_hands(stream, answer, host, target));
    if (!answered) co_return Entry{fmt::format("no answer within {} s", kEnterMax.count())};
    const auto failed = *answered;
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
        if (const auto failed = co_await net::read(stream, event)) co_return failed;
        ++figures.events;
        figures.event_bytes += event.size();
        event.clear();
    }
}

} // namespace

asio::awaitable<void> watch(AudienceShared& shared, std::string session) {
    const auto executor = co_await asio::this_coro::executor;
    asio::steady_timer pause(executor);
    AudienceFigures& figures = shared.figures;
    bool was_let_in = false; // a viewer is counted once, as admitted if it ever was
    bool was_refused = false;
    while (!shared.stopped) {
        Stream stream(net::client_stream(executor, shared.http.tls));
        Entry entry = co_await enter(stream, shared, session);
        const bool watches = entry.trouble.empty();
        if (watches) {
            if (!std::exchange(was_let_in, true)) {
                ++figures.viewers_let_in;
                if (was_refused) --figures.viewers_refused;
            }
            ++figures.watching;
            const auto ended = co_await take_events(stream, figures);
            entry.trouble = net::failure_text(stream.next_layer(), ended);
            --figures.watching;
        }
        if (shared.stopped) co_return;
        if (watches) ++figures.viewer_ends;
        if (entry.is_refused && !was_let_in && !std::exchange(was_refused, true)) ++figures.viewers_refused;
        figures.trouble = fmt::format("a viewer of session {}: {}", session, entry.trouble);
        pause.expires_after(kPause);
        co_await pause.async_wait(kAwaitTuple);
    }
}

// Tile readers --------------------------------------------------------------------------------------------------------

namespace {

constexpr unsigned kNotModified = 304;

/// One tile reader, with the ETags it has seen and its next request.
class TileReader {
public:
    TileReader(AudienceShared& shared, std::string session, asio::any_io_executor executor, const TileTour& tour)
        : shared_(shared), session_(std::move(session)), http_(executor, shared.http), timer_(executor), tour_(tour) {}

    asio::awaitable<void> run() {
        for (;;) {
            const TileTour::Step step = tour_.next();
            timer_.expires_at(shared_.clock.at(step.at));
            co_await timer_.async_wait(kAwaitTuple);
            if (shared_.stopped) co_return;
            if (step.is_list) {
                co_await list(step.layer);
            } else {
                co_await fetch(fmt::format("/api/v1/sessions/{}/tiles/{}/9/{}/{}.png", session_, step.layer,
                                           step.tile.x, step.tile.y),
                               step.at);
            }
        }
    }

private:
    asio::awaitable<void> list(std::string layer) {
        auto tiles = co_await tiles_of(http_, session_, std::move(layer));
        if (!tiles && !shared_.stopped) note(tiles.error());
        tour_.listed(tiles ? std::move(*tiles) : std::vector<TilePlace>());
    }

    asio::awaitable<void> fetch(std::string target, Micros meant) {
        AudienceFigures& figures = shared_.figures;
        std::string& etag = etags_[target];
        const std::uint64_t before = http_.bytes_in();
        const auto answer = co_await http_.ask(boost::beast::http::verb::get, target, etag);
        if (shared_.stopped) co_return; // the answer may be incomplete
        ++figures.tile_requests;
        figures.tile_bytes += http_.bytes_in() - before;
        if (!answer) co_return note(answer.error());
        if (answer->status != net::kOk && answer->status != kNotModified) co_return note(refusal(*answer, target));
        figures.tile_latency.record(shared_.clock.now() - meant);
        if (answer->status == kNotModified) ++figures.tiles_unchanged;
        if (answer->status == net::kOk) etag = answer->etag;
    }

    void note(const Error& error) {
        ++shared_.figures.tiles_failed;
        shared_.figures.trouble = "a tile reader: " + error.message;
    }

    AudienceShared& shared_;
    std::string session_;
    net::HttpConnection http_;
    asio::steady_timer timer_;
    TileTour tour_;
    std::unordered_map<std::string, std::string> etags_; // by target
};

} // namespace

asio::awaitable<void> read_tiles(AudienceShared& shared, std::string session, double rate, Micros delay) {
    TileReader reader(shared, std::move(session), co_await asio::this_coro::executor,
                      TileTour(rate, shared.clock.now() + delay));
    co_await reader.run();
}

// Both ----------------------------------------------------------------------------------------------------------------

Audience::Audience(const AudiencePlan& plan, const RunClock& clock)
    : plan_(plan), shared_{clock, plan.http, figures_}, thread_([this] { io_.run(); }) {}

Audience::~Audience() { stop(); }

void Audience::begin() {
    const auto session = [this](std::uint32_t number) { return plan_.sessions[number % plan_.sessions.size()]; };
    for (std::uint32_t i = 0; i < plan_.viewers; ++i) {
        asio::co_spawn(io_, watch(shared_, session(i)), asio::detached);
    }
    for (std::uint32_t i = 0; i < plan_.tile_readers; ++i) {
        const auto delay = static_cast<Micros>(i * static_cast<double>(kSecond) / plan_.tile_rate / plan_.tile_readers);
        asio::co_spawn(io_, read_tiles(shared_, session(i), plan_.tile_rate, delay), asio::detached);
    }
}

std::unique_ptr<AudienceFigures> Audience::look() {
    if (!thread_.joinable()) return std::make_unique<AudienceFigures>(figures_);
    std::promise<std::unique_ptr<AudienceFigures>> seen;
    asio::post(io_, [&] { seen.set_value(std::make_unique<AudienceFigures>(figures_)); });
    return seen.get_future().get();
}

void Audience::stop() {
    if (!thread_.joinable()) return;
    asio::post(io_, [this] {
        shared_.stopped = true;
        io_.stop();
    });
    thread_.join();
}

} // namespace scanloom::load
