#pragma once

#include "server/ingest/robot_link.hpp"
#include "server/sockets/port_tls.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>

namespace scanloom::ingest {

struct IngestConfig {
    LinkConfig link;
    std::size_t links_max = 10'000;                        ///< that said hello; more are refused with an Error
    std::size_t greeting_max = 256;                        ///< that did not yet; one more, and the oldest is cut off
    std::shared_ptr<const sockets::PortTls> tls = nullptr; ///< none: robots speak plainly
};

/// Listens for robots and serves each on a link of its own.
///
/// Connections on which no hello was said have a limit of their own, so that silent ones keep no robot out: a robot
/// greets at once. Those who say hello at the same moment may pass links_max, by greeting_max at most.
/// Sessions that robots ask for are made one at a time: however many wait for theirs, they leave the rest of
/// LinkServices::may_wait to others.
/// Thread  the io_context's; start() and stop() from any.
class IngestServer {
public:
    /// Throws boost::system::system_error when the endpoint cannot be listened on.
    IngestServer(boost::asio::io_context& io, const boost::asio::ip::tcp::endpoint& endpoint, LinkServices services,
                 const IngestConfig& config);

    /// The port listened on, also when 0 was asked for.
    [[nodiscard]] std::uint16_t port() const { return port_; }

    void start();

    /// Accepts no more. Links end when their sessions close.
    void stop();

private:
    enum class Standing { kGreeting, kServed, kLeaving };

    /// A connection that is open.
    struct Guest {
        std::shared_ptr<RobotLink> link;
        Standing standing;
    };

    void take(boost::asio::ip::tcp::socket socket);
    void begin(const std::shared_ptr<Guest>& guest);
    void make_room_for_greeting();
    void change(Guest& guest, Standing standing);
    void leave(const std::shared_ptr<Guest>& guest);
    [[nodiscard]] std::size_t& count(Standing standing) { return counts_[static_cast<std::size_t>(standing)]; }

    boost::asio::io_context& io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_;
    LinkServices services_;
    IngestConfig config_;

    // On the acceptor's strand.
    std::list<std::shared_ptr<Guest>> greeting_; // oldest first
    std::array<std::size_t, 3> counts_{};        // guests by standing
};

} // namespace scanloom::ingest
