#include "server/ingest/ingest_server.hpp"

#include "server/sockets/listening_port.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <spdlog/spdlog.h>

namespace scanloom::ingest {
namespace asio = boost::asio;

IngestServer::IngestServer(asio::io_context& io, const asio::ip::tcp::endpoint& endpoint, LinkServices services,
                           const IngestConfig& config)
    : io_(io), acceptor_(asio::make_strand(io), endpoint), port_(acceptor_.local_endpoint().port()),
      services_(services), config_(config), limits_(config.links_max, config.greeting_max) {
    services_.blocking_executor = asio::make_strand(services.blocking_executor);
}

void IngestServer::start() {
    asio::co_spawn(acceptor_.get_executor(),
                   sockets::accept_each(acceptor_, io_, "a robot",
                                        [this](asio::ip::tcp::socket socket) { on_accepted(std::move(socket)); }),
                   asio::detached);
}

void IngestServer::stop() {
    asio::post(acceptor_.get_executor(), [this] {
        boost::system::error_code ignored;
        acceptor_.close(ignored);
    });
}

void IngestServer::on_accepted(asio::ip::tcp::socket socket) {
    using Admission = ConnectionLimits::Admission;
    const auto [admission, id, oldest] = limits_.on_accepted();
    if (admission != Admission::kServe && services_.audit.admit_log_line())
        spdlog::warn("a robot was refused: {} links are open, the most allowed", config_.links_max);
    if (admission == Admission::kClose) return;
    if (oldest) cut_off(*oldest);
    services_.counters.links_open.Increment();
    try {
        auto connection = std::make_shared<RobotConnection>(sockets::stream_over(std::move(socket), config_.tls),
                                                            services_, config_.link);
        connections_.emplace(id, connection);
        begin(id, *connection, admission == Admission::kServe);
    } catch (...) {
        leave(id);
        throw;
    }
}

void IngestServer::begin(ConnectionLimits::Id id, RobotConnection& connection, bool is_served) {
    const auto on_strand = [strand = acceptor_.get_executor()](auto event) {
        return [strand, event] { asio::post(strand, event); };
    };
    auto on_closed = on_strand([this, id] { leave(id); });
    if (is_served) {
        connection.serve(on_strand([this, id] { limits_.on_hello(id); }), std::move(on_closed));
    } else {
        connection.turn_away(limits_.too_many(), std::move(on_closed));
    }
}

void IngestServer::cut_off(ConnectionLimits::Id id) {
    if (services_.audit.admit_log_line())
        spdlog::warn("a connection was closed: it has sent no hello, like {} others, the most allowed",
                     config_.greeting_max);
    if (const auto connection = connections_[id].lock()) connection->cut_off();
}

void IngestServer::leave(ConnectionLimits::Id id) {
    limits_.on_closed(id);
    connections_.erase(id);
    services_.counters.links_open.Decrement();
}

} // namespace scanloom::ingest
