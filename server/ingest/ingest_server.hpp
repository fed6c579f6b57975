#pragma once

#include "server/ingest/robot_connection.hpp"
#include "server/sockets/listening_port.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>

namespace scanloom::ingest {

/// Settings of an IngestServer.
struct IngestConfig {
    link::ServerProtocolConfig link;
    std::size_t links_max = 10'000;                        ///< that sent a hello; more are refused with an Error
    std::size_t greeting_max = 256;                        ///< without a hello; beyond it, the oldest is closed
    std::shared_ptr<const sockets::PortTls> tls = nullptr; ///< null: robots connect without TLS
};

/// Listens for robots and serves each connection with a RobotConnection.
///
/// Connections that have not sent a hello have their own limit, so that silent connections cannot keep robots out: a
/// robot sends its hello at once. Connections that send it at the same moment may exceed links_max, by at most
/// greeting_max.
///
/// Sessions that robots create are created one at a time. However many robots wait for theirs, they occupy one thread
/// of LinkServices::may_wait.
/// Threads: those of the io_context; start() and stop() from any thread.
class IngestServer {
public:
    /// Opens the port. Throws boost::system::system_error if the server cannot listen on the endpoint.
    IngestServer(boost::asio::io_context& io, const boost::asio::ip::tcp::endpoint& endpoint, LinkServices services,
                 const IngestConfig& config);

    /// Returns the port that the server listens on; the actual one if the endpoint's port is 0.
    [[nodiscard]] std::uint16_t port() const { return port_; }

    /// Starts accepting connections.
    void start();

    /// Stops accepting connections. Links end when their sessions close.
    void stop();

private:
    /// Whether a connection has sent its hello.
    enum class State { kWithoutHello, kServed, kLeaving };

    /// An open connection.
    struct Entry {
        std::weak_ptr<RobotConnection> connection; // its pending operations own it
        State state;
    };

    void on_accepted(boost::asio::ip::tcp::socket socket);
    void begin(const std::shared_ptr<Entry>& entry, RobotConnection& connection);
    void make_room();
    void change(Entry& entry, State state);
    void leave(const std::shared_ptr<Entry>& entry);
    [[nodiscard]] std::size_t& count(State of) { return counts_[static_cast<std::size_t>(of)]; }

    boost::asio::io_context& io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_;
    LinkServices services_;
    IngestConfig config_;

    // On the acceptor's strand.
    std::list<std::shared_ptr<Entry>> without_hello_; // oldest first
    std::array<std::size_t, 3> counts_{};             // entries by state
};

} // namespace scanloom::ingest
