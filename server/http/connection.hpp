#pragma once

#include "common/net/link_stream.hpp"
#include "server/http/deadline.hpp"
#include "server/http/incoming.hpp"
#include "server/http/lane.hpp"
#include "server/http/peer_wait.hpp"
#include "server/http/refusals.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/service.hpp"
#include "server/live/viewer.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string_view>

namespace scanloom::http {

/// One connection: shakes hands where the port has TLS, reads a request, has it answered, writes the answer, and again,
/// in order. A request that is invited to watch a session is the last: the connection becomes a live::Viewer's.
///
/// Chunked bodies are read, trailers are not: Beast 1.81 throws std::length_error at long ones, which the buffer's
/// limit prevents here.
/// Thread  everything runs on the socket's executor, a strand; stop() and abort() may be called from any.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    Connection(net::LinkStream stream, std::shared_ptr<const Service> service);

    /// Serves until the peer hangs up, a deadline passes, the peer breaks the protocol, or stop().
    [[nodiscard]] boost::asio::awaitable<void> run();

    /// Answers the request under way, if there is one, and closes.
    void stop();

    /// Closes at once.
    void abort();

    /// Returns how far the peer is behind: for how long it is waited for, minus the time that what it has sent or taken
    /// meanwhile may take (read_rate_min, write_rate_min). nullopt while the peer waits for the server, while it
    /// watches a session, and after make_room(). Thread: any.
    [[nodiscard]] std::optional<std::chrono::duration<double>> behind() const noexcept;

    /// Closes if the peer is still waited for, because another connection needs the place.
    void make_room();

private:
    [[nodiscard]] boost::asio::awaitable<bool> shake_hands();
    [[nodiscard]] boost::asio::awaitable<bool> wait_for_request();
    [[nodiscard]] boost::asio::awaitable<bool> serve_request();
    [[nodiscard]] boost::asio::awaitable<boost::beast::error_code> read_header(Parser& parser);
    [[nodiscard]] boost::asio::awaitable<bool> read_body(Parser& parser);
    [[nodiscard]] boost::asio::awaitable<bool> take_body(Parser& parser, std::shared_ptr<const void>& slot);
    [[nodiscard]] boost::asio::awaitable<void> show(const live::Invitation& invitation, const Incoming& upgrade);
    [[nodiscard]] boost::asio::awaitable<void> wake(Asleep asleep);
    [[nodiscard]] boost::asio::awaitable<Response> compute(Lane lane, Request request,
                                                           std::shared_ptr<const void> slot);
    [[nodiscard]] boost::asio::awaitable<void> refuse(boost::beast::error_code reason);
    /// How the request wants to be answered.
    struct Manner {
        bool with_body = true;
        bool keep_alive = false;
        bool takes_chunks = true; ///< HTTP/1.1
    };

    [[nodiscard]] boost::asio::awaitable<bool> write(const Response& response, Manner manner);
    [[nodiscard]] boost::asio::awaitable<bool> write_stream(BodyStream& stream, Framing framing);
    [[nodiscard]] boost::asio::awaitable<bool> write_all(std::string_view head, std::string_view body);
    [[nodiscard]] boost::asio::awaitable<void> linger();
    void begin_to_wait();
    void end_waiting();
    void close();
    [[nodiscard]] boost::asio::awaitable<void> tell_plainly(std::string_view sentence);

    net::LinkStream stream_; // its socket never blocks
    Deadline deadline_;      // closes it
    boost::beast::flat_buffer buffer_;
    std::string peer_; // the address
    std::shared_ptr<const Service> service_;
    std::shared_ptr<live::Viewer> viewer_; // has the socket, once there is one
    bool idle_ = false;                    // between requests, or before the first
    bool waits_ = false;                   // for the peer
    PeerWait wait_;                        // the same, for other threads
    bool stopping_ = false;
    bool must_linger_ = false; // the peer may still have the last answer to read
};

} // namespace scanloom::http
