#pragma once

#include "server/ingest/connection_limits.hpp"
#include "server/ingest/robot_connection.hpp"
#include "server/sockets/listening_port.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
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
/// ConnectionLimits decides which connections are served.
///
/// Sessions that robots create are created one at a time. However many robots wait for theirs, they occupy one thread
/// of LinkServices::blocking_executor.
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
    void on_accepted(boost::asio::ip::tcp::socket socket);
    void begin(ConnectionLimits::Id id, RobotConnection& connection, bool is_served);
    void cut_off(ConnectionLimits::Id id);
    void leave(ConnectionLimits::Id id);

    boost::asio::io_context& io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_;
    LinkServices services_;
    IngestConfig config_;

    // On the acceptor's strand.
    ConnectionLimits limits_;
    std::map<ConnectionLimits::Id, std::weak_ptr<RobotConnection>> connections_; // their pending operations own them
};

} // namespace scanloom::ingest
