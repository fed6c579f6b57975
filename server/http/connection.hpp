#pragma once

#include "common/net/link_stream.hpp"
#include "server/http/deadline.hpp"
#include "server/http/forwarder.hpp"
#include "server/http/incoming.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/response_writer.hpp"
#include "server/http/server_config.hpp"
#include "server/live/viewer.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace scanloom::http {

/// Serves one HTTP connection: performs the TLS handshake if the port has TLS, then reads requests and writes their
/// responses in order. After a request that is accepted as a live subscription, a live::Viewer takes over the
/// connection.
///
/// Chunked bodies are read, trailers are not: Beast 1.81 throws std::length_error for long trailers. The limit of the
/// buffer prevents this here.
/// Threads: everything runs on the socket's executor, a strand. stop() and abort() may be called on any thread.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    Connection(net::LinkStream stream, std::shared_ptr<const Service> service);

    /// Serves requests until the peer disconnects, a deadline passes, the peer violates the protocol, or stop() is
    /// called.
    [[nodiscard]] boost::asio::awaitable<void> run();

    /// Answers the current request, if any, and closes.
    void stop();

    /// Closes at once.
    void abort();

    /// Returns how far the peer is behind: the time that the server has waited for it, minus the time that the data
    /// sent or received meanwhile may take (read_rate_min, write_rate_min). Returns nullopt while the peer waits for
    /// the server, while it watches a session, and after make_room().
    /// Threads: any.
    [[nodiscard]] std::optional<std::chrono::duration<double>> behind() const noexcept;

    /// Closes the connection if the server still waits for the peer, to free its place for another connection.
    void make_room();

private:
    [[nodiscard]] boost::asio::awaitable<bool> shake_hands();
    [[nodiscard]] boost::asio::awaitable<bool> wait_for_request();
    [[nodiscard]] boost::asio::awaitable<bool> serve_request();
    [[nodiscard]] boost::asio::awaitable<boost::beast::error_code> read_header(Parser& parser);
    [[nodiscard]] boost::asio::awaitable<bool> read_body(Parser& parser);
    [[nodiscard]] std::variant<Api::Admitted, Response> admit(const Request& head,
                                                              std::variant<Api::Routed, Response> routed) const;
    [[nodiscard]] Request request_of(const Incoming& head) const;
    [[nodiscard]] boost::asio::awaitable<std::optional<bool>>
    pass_on(const Api::Admitted& admitted, const Request& request, const Incoming& message, Manner manner);
    [[nodiscard]] boost::asio::awaitable<void> show(const live::ViewedSession& viewed, const Incoming& upgrade);
    [[nodiscard]] boost::asio::awaitable<void> refuse(boost::beast::error_code reason);
    void close();

    net::LinkStream stream_; // its socket never blocks
    Deadline deadline_;      // closes it
    PeerWait wait_;          // for its peer
    boost::beast::flat_buffer buffer_;
    std::string peer_; // the address
    std::shared_ptr<const Service> service_;
    ResponseWriter writer_;
    Forwarder forwarder_;
    std::shared_ptr<live::Viewer> viewer_; // owns the socket once it is set
    bool idle_ = false;                    // between requests, or before the first one
    bool stopping_ = false;
};

} // namespace scanloom::http
