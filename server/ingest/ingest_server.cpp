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

asio::awaitable<void> turn_away(asio::ip::tcp::socket socket, std::size_t links_max) {
    std::string frame;
    wire::encode(wire::LinkError{{Errc::kTooLarge,
                                  fmt::format("{} robots are connected, the most this server takes; try again later",
                                              links_max)},
                                 true},
                 frame);
    co_await asio::async_write(socket, asio::buffer(frame), asio::as_tuple(asio::use_awaitable));
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
        if (open_ >= config_.links_max) {
            spdlog::warn("a robot was turned away: {} links are open, the most allowed", open_);
            const auto executor = socket.get_executor();
            asio::co_spawn(executor, turn_away(std::move(socket), config_.links_max), asio::detached);
            continue;
        }
        ++open_;
        auto link = std::make_shared<RobotLink>(std::move(socket), services_, config_.link);
        asio::co_spawn(
            link->executor(), [link] { return link->run(); },
            asio::bind_executor(acceptor_.get_executor(), [this](std::exception_ptr) { --open_; }));
    }
}

} // namespace scanloom::ingest
