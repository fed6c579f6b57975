#pragma once

#include "common/net/link_stream.hpp"
#include "common/net/tls.hpp"
#include "server/http/incoming.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/response_writer.hpp"
#include "server/store/shared_sessions.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/parser.hpp>

#include <optional>
#include <string>

namespace scanloom::http {

/// Passes requests of one connection on to the server that has their session, and its responses back, piece by piece.
/// Waits for that server as long as it does not count as dead.
/// Keeps the connection to that server for the next request. A WebSocket is passed on until one side ends it.
/// Threads: the executor of the client's connection, except for the constructor.
class Forwarder {
public:
    /// All arguments must outlive this object.
    /// @param client  of the connection
    /// @param writer  writes to it
    Forwarder(net::LinkStream& client, ResponseWriter& writer, const Service& service)
        : client_(client), writer_(writer), service_(service) {}

    enum class Outcome {
        kAnswered,   ///< the client's connection can take another request
        kClosed,     ///< the client's connection must be closed
        kNotThere,   ///< the server cannot be reached or does not have the session; nothing was sent to the client
        kInterrupted ///< it is not known whether the server has carried the request out; nothing was sent to the client
    };

    /// Passes a request on and waits for the end of the response.
    /// @param message  the request as received, for its fields; its body is in `request`
    [[nodiscard]] boost::asio::awaitable<Outcome> forward(const store::NodeInfo& owner, const Request& request,
                                                          const Incoming& message, Manner manner);

    /// Ends a WebSocket that is passed on; passes none on from now.
    void stop();

    /// Closes the connection to the other server at once.
    void abort();

private:
    using Parser = boost::beast::http::response_parser<boost::beast::http::buffer_body>;

    [[nodiscard]] boost::asio::awaitable<Outcome> exchange(const store::NodeInfo& owner, const Request& request,
                                                           const Incoming& message, Manner manner);
    [[nodiscard]] boost::asio::awaitable<void> close_if_dead(const store::NodeInfo& owner);
    [[nodiscard]] boost::asio::awaitable<bool> connect(const std::string& place);
    [[nodiscard]] boost::asio::awaitable<bool> ask(const std::string& head, const std::string& body, Parser& parser);
    [[nodiscard]] boost::asio::awaitable<Outcome> answer(Parser& parser, const Manner& manner);
    [[nodiscard]] boost::asio::awaitable<bool> pass_body(Parser& parser);
    [[nodiscard]] boost::asio::awaitable<void> pass_socket();

    net::LinkStream& client_;
    ResponseWriter& writer_;
    const Service& service_;
    std::optional<net::LinkStream> server_;
    std::string place_; // of server_
    boost::beast::flat_buffer buffer_;
    bool passes_socket_ = false;
    bool stopped_ = false;
};

} // namespace scanloom::http
