#include "load/net/http_connection.hpp"
#include "load/net/onlooker.hpp"
#include "load/net/server_api.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

#include <array>
#include <unordered_map>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr auto kUse = asio::as_tuple(asio::use_awaitable);
constexpr std::array<const char*, 2> kLayers{"occupancy", "classification"}; ///< what the viewer shows first
constexpr unsigned kOk = 200;
constexpr unsigned kNotModified = 304;

/// One reader: what it has seen, and when it is to ask for more.
class TileReader {
public:
    TileReader(OnlookerShared& shared, std::string session, asio::any_io_executor executor, double rate, Micros first)
        : shared_(shared), session_(std::move(session)), http_(executor, shared.http), timer_(executor),
          period_(static_cast<Micros>(static_cast<double>(kSecond) / rate)), next_(first) {}

    asio::awaitable<void> run() {
        for (std::size_t round = 0; !shared_.stopped; ++round) {
            const std::string layer = kLayers[round % kLayers.size()];
            co_await wait_for_turn();
            const auto tiles = co_await tiles_of(http_, session_, layer);
            if (!tiles) note(tiles.error());
            if (!tiles || shared_.stopped) continue;
            for (const TilePlace& tile : *tiles) {
                co_await wait_for_turn();
                if (shared_.stopped) co_return;
                co_await fetch(
                    fmt::format("/api/v1/sessions/{}/tiles/{}/9/{}/{}.png", session_, layer, tile.x, tile.y));
            }
        }
    }

private:
    asio::awaitable<void> wait_for_turn() {
        meant_ = next_;
        next_ += period_;
        timer_.expires_at(shared_.clock.at(meant_));
        co_await timer_.async_wait(kUse);
    }

    asio::awaitable<void> fetch(std::string target) {
        AudienceFigures& figures = shared_.figures;
        std::string& etag = etags_[target];
        const std::uint64_t before = http_.bytes_in();
        const auto answer = co_await http_.ask(boost::beast::http::verb::get, target, etag);
        if (shared_.stopped) co_return; // it may be cut off in the middle
        ++figures.tile_requests;
        figures.tile_bytes += http_.bytes_in() - before;
        if (!answer) co_return note(answer.error());
        if (answer->status != kOk && answer->status != kNotModified) co_return note(refusal(*answer, target));
        figures.tile_latency.record(shared_.clock.now() - meant_);
        if (answer->status == kNotModified) ++figures.tiles_unchanged;
        if (answer->status == kOk) etag = answer->etag;
    }

    void note(const Error& error) {
        ++shared_.figures.tiles_failed;
        shared_.figures.trouble = "a reader of tiles: " + error.message;
    }

    OnlookerShared& shared_;
    std::string session_;
    HttpConnection http_;
    asio::steady_timer timer_;
    Micros period_;
    Micros next_;
    Micros meant_ = 0;
    std::unordered_map<std::string, std::string> etags_; // by target
};

} // namespace

asio::awaitable<void> read_tiles(OnlookerShared& shared, std::string session, double rate, Micros delay) {
    TileReader reader(shared, std::move(session), co_await asio::this_coro::executor, rate, shared.clock.now() + delay);
    co_await reader.run();
}

} // namespace scanloom::load
