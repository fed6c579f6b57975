#pragma once

#include "common/net/link_stream.hpp"
#include "server/http/deadline.hpp"
#include "server/http/incoming.hpp"
#include "server/http/lane.hpp"
#include "server/http/refusals.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/service.hpp"
#include "server/live/viewer.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string_view>

namespace scanloom::http {

/// One connection: shakes hands where the port has TLS, reads a request, has it answered, writes the answer, and again,
/// in order. A request that is invited to watch a session is the last: the connection becomes a live::Viewer's.
///
/// No request with Transfer-Encoding is read. Nothing here needs one, and Beast 1.81 throws
/// std::length_error at long chunked trailers.
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

    /// Since when it waits for a whole header of a request; nothing while one is answered or watched, and once it was
    /// asked to make room.
    [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> waits_since() const noexcept;

    /// Closes if it still waits for a header, as somebody else needs the place.
    void make_room();

private:
    static constexpr auto kNever = std::chrono::steady_clock::time_point::max();

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
    bool waits_ = false;                   // until the header of the next request is there
    std::atomic<std::chrono::steady_clock::time_point> waits_since_ = kNever;
    bool stopping_ = false;
    bool must_linger_ = false; // the peer may still have the last answer to read
};

} // namespace scanloom::http
