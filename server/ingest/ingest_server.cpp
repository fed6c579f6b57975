#include "server/ingest/ingest_server.hpp"

#include "server/sockets/listening_port.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace scanloom::ingest {
namespace asio = boost::asio;
namespace {

/// Bound on connections beyond the limit that stay open to receive the Error; more are closed without one.
constexpr std::size_t kTurnedAwayMax = 64;

wire::LinkError too_many(std::size_t links) {
    return {
        {Errc::kOverloaded, fmt::format("{} robots are connected, the most this server takes; try again later", links)},
        true};
}

} // namespace

IngestServer::IngestServer(asio::io_context& io, const asio::ip::tcp::endpoint& endpoint, LinkServices services,
                           const IngestConfig& config)
    : io_(io), acceptor_(asio::make_strand(io), endpoint), port_(acceptor_.local_endpoint().port()),
      services_(services), config_(config) {
    services_.may_wait = asio::make_strand(services.may_wait);
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
    const bool full = count(State::kServed) >= config_.links_max;
    if (full && services_.audit.admit_log_line())
        spdlog::warn("a robot was refused: {} links are open, the most allowed", config_.links_max);
    if (full && count(State::kLeaving) >= kTurnedAwayMax) return;
    if (!full) make_room();
    auto connection = std::make_shared<RobotConnection>(sockets::stream_over(std::move(socket), config_.tls), services_,
                                                        config_.link);
    const auto entry = std::make_shared<Entry>(Entry{connection, full ? State::kLeaving : State::kWithoutHello});
    if (!full) without_hello_.push_back(entry);
    ++count(entry->state);
    services_.counters.links_open.Increment();
    try {
        begin(entry, *connection);
    } catch (...) {
        leave(entry);
        throw;
    }
}

void IngestServer::begin(const std::shared_ptr<Entry>& entry, RobotConnection& connection) {
    const auto strand = acceptor_.get_executor();
    auto on_hello = [this, strand, weak = std::weak_ptr(entry)] {
        asio::post(strand, [this, weak] {
            const auto known = weak.lock();
            if (known && known->state == State::kWithoutHello) change(*known, State::kServed);
        });
    };
    auto on_closed = [this, strand, entry] { asio::post(strand, [this, entry] { leave(entry); }); };
    if (entry->state == State::kLeaving) {
        connection.turn_away(too_many(config_.links_max), std::move(on_closed));
    } else {
        connection.serve(std::move(on_hello), std::move(on_closed));
    }
}

/// Closes the oldest connection without a hello, as the one that is least likely to be a robot.
void IngestServer::make_room() {
    if (count(State::kWithoutHello) < config_.greeting_max) return;
    const auto oldest = without_hello_.front();
    if (services_.audit.admit_log_line())
        spdlog::warn("a connection was closed: it has sent no hello, like {} others, the most allowed",
                     config_.greeting_max);
    change(*oldest, State::kLeaving);
    if (const auto connection = oldest->connection.lock()) connection->cut_off();
}

void IngestServer::change(Entry& entry, State state) {
    if (entry.state == State::kWithoutHello)
        std::erase_if(without_hello_, [&](const auto& one) { return one.get() == &entry; });
    --count(entry.state);
    entry.state = state;
    ++count(state);
}

void IngestServer::leave(const std::shared_ptr<Entry>& entry) {
    change(*entry, State::kLeaving);
    --count(State::kLeaving);
    services_.counters.links_open.Decrement();
}

} // namespace scanloom::ingest
