#include "common/net/await_tuple.hpp"
#include "load/core/tile_tour.hpp"
#include "load/net/http_connection.hpp"
#include "load/net/onlooker.hpp"
#include "load/net/server_api.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <unordered_map>
#include <vector>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr unsigned kNotModified = 304;

/// One tile reader, with the ETags it has seen and its next request.
class TileReader {
public:
    TileReader(OnlookerShared& shared, std::string session, asio::any_io_executor executor, const TileTour& tour)
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
        if (answer->status != kOk && answer->status != kNotModified) co_return note(refusal(*answer, target));
        figures.tile_latency.record(shared_.clock.now() - meant);
        if (answer->status == kNotModified) ++figures.tiles_unchanged;
        if (answer->status == kOk) etag = answer->etag;
    }

    void note(const Error& error) {
        ++shared_.figures.tiles_failed;
        shared_.figures.trouble = "a tile reader: " + error.message;
    }

    OnlookerShared& shared_;
    std::string session_;
    HttpConnection http_;
    asio::steady_timer timer_;
    TileTour tour_;
    std::unordered_map<std::string, std::string> etags_; // by target
};

} // namespace

asio::awaitable<void> read_tiles(OnlookerShared& shared, std::string session, double rate, Micros delay) {
    TileReader reader(shared, std::move(session), co_await asio::this_coro::executor,
                      TileTour(rate, shared.clock.now() + delay));
    co_await reader.run();
}

} // namespace scanloom::load
