#include "server/http/server.hpp"

#include "server/http/problem.hpp"
#include "server/sockets/listening_port.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace scanloom::http {

namespace net = boost::asio;
using net::ip::tcp;

namespace {

constexpr std::size_t kOnTheirWayOutMax = 64; // connections that are closing

} // namespace

bool may_connect(const net::ip::address& peer, std::size_t open, const ServerConfig& config) {
    if (peer.is_v6() && peer.to_v6().is_v4_mapped()) { // on a port that accepts IPv4 and IPv6
        return may_connect(net::ip::make_address_v4(net::ip::v4_mapped, peer.to_v6()), open, config);
    }
    return open < config.connections_per_peer_max || peer.is_loopback() ||
           std::ranges::find(config.proxies, peer) != config.proxies.end();
}

Result<std::shared_ptr<Server>> Server::listen(net::io_context& io, const Api& api, const ServerConfig& config,
                                               metrics::HttpCounters& counters) {
    const auto endpoint = config.endpoint;
    const bool check_host = endpoint.address().is_loopback() || !config.host_names.empty();
    auto service = std::make_shared<const Service>(
        Service{config, check_host, api, counters, {config.live.viewers_max, config.live.viewers_per_session_max}});
    std::shared_ptr<Server> server(new Server(io, std::move(service)));
    if (const auto failed = server->bind()) {
        return Error{Errc::kUnreachable,
                     fmt::format("cannot listen for HTTP on {}:{}: {}; choose another address or port",
                                 endpoint.address().to_string(), endpoint.port(), failed.message())};
    }
    return server;
}

Server::Server(net::io_context& io, std::shared_ptr<const Service> service)
    : io_(io), service_(std::move(service)), strand_(net::make_strand(io)), acceptor_(strand_), drained_(strand_) {}

boost::system::error_code Server::bind() {
    const auto& endpoint = service_->config.endpoint;
    boost::system::error_code failed;
    acceptor_.open(endpoint.protocol(), failed);
    if (!failed) acceptor_.set_option(tcp::acceptor::reuse_address(true), failed);
    if (!failed) acceptor_.bind(endpoint, failed);
    if (!failed) acceptor_.listen(net::socket_base::max_listen_connections, failed);
    if (!failed) port_ = acceptor_.local_endpoint(failed).port();
    return failed;
}

void Server::start() {
    net::dispatch(strand_, [self = shared_from_this()] {
        self->accepting_ = true;
        net::co_spawn(self->strand_, self->accept_loop(), net::detached);
    });
}

void Server::stop(std::function<void()> done) {
    net::dispatch(strand_, [self = shared_from_this(), done = std::move(done)]() mutable {
        self->done_ = std::move(done);
        boost::system::error_code ignored;
        self->acceptor_.close(ignored);
        self->drained_.expires_after(self->service_->config.drain);
        self->drained_.async_wait([self](boost::system::error_code cancelled) {
            if (cancelled) return;
            for (const auto& [connection, peer] : self->connections_) connection->abort();
        });
        for (const auto& [connection, peer] : self->connections_) connection->stop();
        self->call_done_when_empty();
    });
}

net::awaitable<void> Server::accept_loop() {
    const auto self = shared_from_this();
    co_await sockets::accept_each(acceptor_, io_, "an HTTP connection",
                                  [this](tcp::socket socket) { take(std::move(socket)); });
    accepting_ = false;
    call_done_when_empty();
}

void Server::take(tcp::socket socket) {
    boost::system::error_code ignored;
    const auto peer = socket.remote_endpoint(ignored).address();
    const auto found = peers_.find(peer);
    const std::size_t of_peer = found == peers_.end() ? 0 : found->second;
    const bool is_closing_enough = of_peer >= service_->config.connections_per_peer_max + kOnTheirWayOutMax;
    if (!may_connect(peer, of_peer, service_->config) && (is_closing_enough || !make_room(&peer)))
        return refuse(std::move(socket), "too many connections of this address are open");
    if (connections_.size() >= service_->config.connections_max && !make_room())
        return refuse(std::move(socket), "too many connections are open");
    socket.set_option(tcp::no_delay(true), ignored);
    const auto executor = socket.get_executor();
    auto connection =
        std::make_shared<Connection>(sockets::stream_over(std::move(socket), service_->config.tls), service_);
    connections_.emplace(connection, peer);
    ++peers_[peer];
    service_->counters.connections_open.Set(static_cast<double>(connections_.size()));
    try {
        net::co_spawn(executor, serve(connection), net::detached);
    } catch (...) {
        forget(connection);
        throw;
    }
}

/// Closes the connection whose peer is furthest behind: it is idle, sends its body slowly or reads slowly.
/// @param of_peer  considers only connections of this address; null: all
/// @return false if every peer waits for this server, or if kOnTheirWayOutMax connections exceed the maximum already
bool Server::make_room(const net::ip::address* of_peer) {
    if (connections_.size() >= service_->config.connections_max + kOnTheirWayOutMax) return false;
    std::shared_ptr<Connection> slowest;
    std::chrono::duration<double> furthest{};
    for (const auto& [connection, peer] : connections_) {
        if (of_peer != nullptr && peer != *of_peer) continue;
        const auto behind = connection->behind();
        if (!behind || (slowest && *behind <= furthest)) continue;
        furthest = *behind;
        slowest = connection;
    }
    if (slowest) slowest->make_room();
    return slowest != nullptr;
}

/// Sends the reason if that is possible without waiting, so that no refusals accumulate.
void Server::refuse(tcp::socket socket, std::string_view why) {
    service_->counters.connections_refused.Increment();
    if (service_->config.tls) return; // a handshake would require waiting
    const auto response = problem(Error{Errc::kOverloaded, fmt::format("{}; try again later", why)}, "");
    const auto text = head_text(response, Persistence::kClose, "") + std::string(response.body.bytes());
    boost::system::error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(net::buffer(text), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
}

net::awaitable<void> Server::serve(std::shared_ptr<Connection> connection) {
    const auto self = shared_from_this();
    try {
        co_await connection->run();
    } catch (const std::exception& failure) {
        spdlog::error("an HTTP connection failed and was closed: {}", failure.what());
    }
    net::post(strand_, [self, connection] { self->forget(connection); });
}

void Server::forget(const std::shared_ptr<Connection>& connection) {
    const auto found = connections_.find(connection);
    if (found != connections_.end()) {
        const auto of_peer = peers_.find(found->second);
        if (--of_peer->second == 0) peers_.erase(of_peer);
        connections_.erase(found);
    }
    service_->counters.connections_open.Set(static_cast<double>(connections_.size()));
    call_done_when_empty();
}

void Server::call_done_when_empty() {
    if (!done_ || accepting_ || !connections_.empty()) return;
    drained_.cancel();
    std::exchange(done_, nullptr)();
}

} // namespace scanloom::http
