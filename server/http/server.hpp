#pragma once

#include "common/error/error.hpp"
#include "server/http/connection.hpp"
#include "server/http/server_config.hpp"
#include "server/metrics/metrics.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>

namespace scanloom::http {

/// Returns whether an address may open another connection. The limit per address keeps one client from using all
/// places. It does not apply to loopback and config.proxies.
/// @param open  current number of connections of this address
[[nodiscard]] bool may_connect(const boost::asio::ip::address& peer, std::size_t open, const ServerConfig& config);

/// Listens, and runs one coroutine per connection.
///
/// Queues: "connections": at most config.connections_max, each with one request at a time, which also bounds the work
///         that waits for the executors. To accept one more, the server closes the connection whose peer is furthest
///         behind (Connection::behind()); if every peer waits for the server, the new one receives 503. At most
///         config.connections_per_peer_max of one address, except loopback and config.proxies.
///         The limits of WorkClasses answer one more request with 503.
///         Live viewers: at most config.live.viewers_max of the connections.
/// Threads: any.
class Server : public std::enable_shared_from_this<Server> {
public:
    /// Binds the port. Connections wait until start().
    ///
    /// @param api  must outlive the server's work on all executors, as must `counters`
    /// Errors: kUnreachable, naming the endpoint, if it is in use or not an address of this machine.
    [[nodiscard]] static Result<std::shared_ptr<Server>>
    listen(boost::asio::io_context& io, const Api& api, const ServerConfig& config, metrics::HttpCounters& counters);

    /// Returns the bound port.
    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

    void start();

    /// Stops accepting, closes idle connections, answers current requests, and calls `done` (on the I/O executor) after
    /// the last connection is closed. After config.drain it closes the remaining connections. Must be called once,
    /// after start().
    void stop(std::function<void()> done);

private:
    Server(boost::asio::io_context& io, std::shared_ptr<const Service> service);

    [[nodiscard]] boost::system::error_code bind();
    [[nodiscard]] boost::asio::awaitable<void> accept_loop();
    [[nodiscard]] boost::asio::awaitable<void> serve(std::shared_ptr<Connection> connection);
    void take(boost::asio::ip::tcp::socket socket);
    [[nodiscard]] bool make_room(const boost::asio::ip::address* of_peer = nullptr);
    void refuse(boost::asio::ip::tcp::socket socket, std::string_view why);
    void forget(const std::shared_ptr<Connection>& connection);
    void call_done_when_empty();

    boost::asio::io_context& io_;
    std::shared_ptr<const Service> service_;
    boost::asio::strand<boost::asio::io_context::executor_type> strand_;
    std::uint16_t port_ = 0;

    // On the strand only.
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::steady_timer drained_;                                           // expires at the end of draining
    std::map<std::shared_ptr<Connection>, boost::asio::ip::address> connections_; // with their peers' addresses
    std::map<boost::asio::ip::address, std::size_t> peers_;                       // number of connections of each
    bool accepting_ = false;
    std::function<void()> done_; // set while stopping
};

} // namespace scanloom::http
