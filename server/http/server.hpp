#pragma once

#include "common/error/error.hpp"
#include "server/http/connection.hpp"
#include "server/http/server_config.hpp"
#include "server/metrics/metrics.hpp"

#include <boost/asio/any_io_executor.hpp>
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

/// Whether an address may open another connection: many of one address would cost the others their places. Loopback
/// and config.proxies are not bounded.
/// @param open  how many the address has
[[nodiscard]] bool may_connect(const boost::asio::ip::address& peer, std::size_t open, const ServerConfig& config);

/// Listens, and runs one coroutine per connection.
///
/// Queue   "connections": at most config.connections_max, each with one request at a time, which
///         also bounds what waits for the executors. For one more the one whose peer is furthest behind is closed
///         (Connection::behind()); if every peer waits for the server, it is answered 503. At most
///         config.connections_per_peer_max of one address, except loopback and config.proxies.
///         "changes": at most config.changes_max requests create or delete sessions; one more is answered 503.
///         "imports": at most config.imports_max maps are read and imported; one more is answered 503.
///         "weaves": at most config.weaves_max requests wait for maps to be woven; one more is answered 503.
///         "paths": at most config.paths_max requests have paths read; one more is answered 503.
///         "plans": at most config.plans_max requests look for ways, or wait for their turn; one more is answered 503.
///         Viewers, who watch live: at most config.live.viewers_max of the connections; one more is answered 503.
/// Thread  any. The counters must outlive the server's work on all executors.
class Server : public std::enable_shared_from_this<Server> {
public:
    /// Binds; connections wait until start().
    ///
    /// Errors  kUnreachable, naming the endpoint: it is taken, or not an address of this machine.
    [[nodiscard]] static Result<std::shared_ptr<Server>> listen(boost::asio::io_context& io, Executors executors,
                                                                const ServerConfig& config, Answering answering,
                                                                metrics::HttpCounters& counters);

    /// The port that is bound.
    [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

    void start();

    /// Accepts nothing more, closes idle connections, answers the requests under way, and calls `done`
    /// (on the I/O executor) when the last connection is closed. After config.drain the rest is cut off.
    /// Pre  called once, after start().
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
    boost::asio::steady_timer drained_;                                           // runs out at the end of draining
    std::map<std::shared_ptr<Connection>, boost::asio::ip::address> connections_; // with their peers
    std::map<boost::asio::ip::address, std::size_t> peers_;                       // how many of each
    bool accepting_ = false;
    std::function<void()> done_; // set while stopping
};

} // namespace scanloom::http
