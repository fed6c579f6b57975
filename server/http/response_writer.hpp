#pragma once

#include "common/net/link_stream.hpp"
#include "server/http/deadline.hpp"
#include "server/http/response.hpp"
#include "server/http/server_config.hpp"

#include <boost/asio/awaitable.hpp>

#include <string_view>

namespace scanloom::http {

/// Writes responses to a connection within its deadlines.
/// Threads: the connection's strand.
class ResponseWriter {
public:
    /// All arguments must outlive this object.
    /// @param deadline  closes the stream
    /// @param wait      measures the time that the peer takes to read
    ResponseWriter(net::LinkStream& stream, Deadline& deadline, PeerWait& wait, const Service& service)
        : stream_(stream), deadline_(deadline), wait_(wait), service_(service) {}

    /// Writes a response and counts it.
    /// @return whether the connection can take another request
    [[nodiscard]] boost::asio::awaitable<bool> write(const Response& response, Manner manner = {});

    /// Writes bytes that are not a complete response.
    /// @return whether they were written
    [[nodiscard]] boost::asio::awaitable<bool> write_all(std::string_view head, std::string_view body = {});

    /// Writes a response without TLS to a peer that sent a request without TLS. The stream has no TLS from then on.
    [[nodiscard]] boost::asio::awaitable<void> write_without_tls(const Response& response);

    /// Makes finish() wait for the peer to read the last response.
    void keep_until_read() noexcept { must_linger_ = true; }

    /// Waits a while for the peer to read the last response. Call before the stream is closed.
    [[nodiscard]] boost::asio::awaitable<void> finish();

private:
    [[nodiscard]] boost::asio::awaitable<bool> write_stream(BodyStream& body, Framing framing);

    net::LinkStream& stream_;
    Deadline& deadline_;
    PeerWait& wait_;
    const Service& service_;
    bool must_linger_ = false;
};

} // namespace scanloom::http
