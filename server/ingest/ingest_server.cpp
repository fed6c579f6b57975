#include "server/ingest/ingest_server.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace scanloom::ingest {
namespace asio = boost::asio;
namespace {

/// Links beyond the limit that are open at the same time to say so; more are closed without a word.
constexpr std::size_t kTurnedAwayMax = 64;

wire::LinkError too_many(std::size_t links) {
    return {
        {Errc::kTooLarge, fmt::format("{} robots are connected, the most this server takes; try again later", links)},
        true};
}

} // namespace

IngestServer::IngestServer(asio::io_context& io, const asio::ip::tcp::endpoint& endpoint, LinkServices services,
                           const IngestConfig& config)
    : io_(io), acceptor_(asio::make_strand(io), endpoint), port_(acceptor_.local_endpoint().port()),
      services_(services), config_(config) {}

void IngestServer::start() { asio::co_spawn(acceptor_.get_executor(), accept(), asio::detached); }

void IngestServer::stop() {
    asio::post(acceptor_.get_executor(), [this] {
        boost::system::error_code ignored;
        acceptor_.close(ignored);
    });
}

asio::awaitable<void> IngestServer::accept() {
    asio::steady_timer pause(acceptor_.get_executor());
    while (acceptor_.is_open()) {
        auto [error, socket] =
            co_await acceptor_.async_accept(asio::make_strand(io_), asio::as_tuple(asio::use_awaitable));
        if (error == asio::error::operation_aborted) continue;
        if (error) { // out of file descriptors, say: try again when some may be free
            spdlog::warn("a robot could not be accepted: {}", error.message());
            pause.expires_after(std::chrono::milliseconds(100));
            co_await pause.async_wait(asio::as_tuple(asio::use_awaitable));
            continue;
        }
        const bool full = open_ >= config_.links_max;
        if (full) spdlog::warn("a robot was turned away: {} links are open, the most allowed", config_.links_max);
        if (open_ >= config_.links_max + kTurnedAwayMax) continue;
        ++open_;
        services_.counters.links_open.Increment();
        auto link = std::make_shared<RobotLink>(std::move(socket), services_, config_.link);
        asio::co_spawn(
            link->executor(),
            [link, full, links_max = config_.links_max] {
                return full ? link->turn_away(too_many(links_max)) : link->run();
            },
            asio::bind_executor(acceptor_.get_executor(), [this](std::exception_ptr) {
                --open_;
                services_.counters.links_open.Decrement();
            }));
    }
}

} // namespace scanloom::ingest
