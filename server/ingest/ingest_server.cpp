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
                                        [this](asio::ip::tcp::socket socket) { take(std::move(socket)); }),
                   asio::detached);
}

void IngestServer::stop() {
    asio::post(acceptor_.get_executor(), [this] {
        boost::system::error_code ignored;
        acceptor_.close(ignored);
    });
}

void IngestServer::take(asio::ip::tcp::socket socket) {
    const bool full = count(Standing::kServed) >= config_.links_max;
    if (full && services_.audit.take_line_of_stranger())
        spdlog::warn("a robot was turned away: {} links are open, the most allowed", config_.links_max);
    if (full && count(Standing::kLeaving) >= kTurnedAwayMax) return;
    if (!full) make_room_for_greeting();
    auto connection = std::make_shared<RobotConnection>(sockets::stream_over(std::move(socket), config_.tls), services_,
                                                        config_.link);
    const auto guest = std::make_shared<Guest>(Guest{connection, full ? Standing::kLeaving : Standing::kGreeting});
    if (!full) greeting_.push_back(guest);
    ++count(guest->standing);
    services_.counters.links_open.Increment();
    try {
        begin(guest, *connection);
    } catch (...) {
        leave(guest);
        throw;
    }
}

void IngestServer::begin(const std::shared_ptr<Guest>& guest, RobotConnection& connection) {
    const auto strand = acceptor_.get_executor();
    auto on_hello = [this, strand, weak = std::weak_ptr(guest)] {
        asio::post(strand, [this, weak] {
            const auto greeted = weak.lock();
            if (greeted && greeted->standing == Standing::kGreeting) change(*greeted, Standing::kServed);
        });
    };
    auto on_closed = [this, strand, guest] { asio::post(strand, [this, guest] { leave(guest); }); };
    if (guest->standing == Standing::kLeaving) {
        connection.turn_away(too_many(config_.links_max), std::move(on_closed));
    } else {
        connection.serve(std::move(on_hello), std::move(on_closed));
    }
}

/// Closes the oldest connection without a hello, as the one that is least likely to be a robot.
void IngestServer::make_room_for_greeting() {
    if (count(Standing::kGreeting) < config_.greeting_max) return;
    const auto oldest = greeting_.front();
    if (services_.audit.take_line_of_stranger())
        spdlog::warn("a connection was cut off: it said no hello, and {} do not, the most allowed",
                     config_.greeting_max);
    change(*oldest, Standing::kLeaving);
    if (const auto connection = oldest->connection.lock()) connection->cut_off();
}

void IngestServer::change(Guest& guest, Standing standing) {
    if (guest.standing == Standing::kGreeting)
        std::erase_if(greeting_, [&](const auto& one) { return one.get() == &guest; });
    --count(guest.standing);
    guest.standing = standing;
    ++count(standing);
}

void IngestServer::leave(const std::shared_ptr<Guest>& guest) {
    change(*guest, Standing::kLeaving);
    --count(Standing::kLeaving);
    services_.counters.links_open.Decrement();
}

} // namespace scanloom::ingest
