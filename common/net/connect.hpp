#pragma once

#include "common/error/error.hpp"
#include "common/net/await_tuple.hpp"
#include "common/net/link_stream.hpp"
#include "common/net/tls.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// How a client connects to a server over TCP, with or without TLS.
namespace scanloom::net {

/// Where a server listens.
struct Address {
    std::string host; ///< host name or address, without brackets
    std::string port; ///< 1 to 65535

    /// Returns HOST:PORT, with an IPv6 address in brackets.
    [[nodiscard]] std::string text() const;
};

/// Parses HOST:PORT. An IPv6 address must be in brackets, as in [::1]:7447; names are not resolved.
/// Errors: kInvalidField if the text has another form.
[[nodiscard]] Result<Address> parse_address(std::string_view text);

using Endpoints = std::vector<boost::asio::ip::tcp::endpoint>;

/// Resolves an address; waits for the name service.
/// Errors: kUnreachable if the host is not known.
[[nodiscard]] Result<Endpoints> resolve(const Address& address);

/// Returns a connection that is not open yet.
/// @param tls  null: not encrypted
[[nodiscard]] LinkStream client_stream(boost::asio::any_io_executor executor, const TlsContext& tls);

/// Names of the other side in messages for people: literals.
struct PeerName {
    std::string_view option = "--server";         ///< that has its address
    std::string_view program = "scanloom-server"; ///< that runs there
};

/// Connects `stream`, which client_stream() returned, and performs the TLS handshake if it is encrypted. The
/// certificate must be valid for the host of `address`. Cancelled by stream.close().
/// @param stream     must outlive the call
/// @param address    the server's, for messages and for its certificate
/// @param endpoints  its addresses; the first one that accepts is used
/// @param timeout    maximum time for connecting, and again for the handshake
/// @param peer       its name in messages
/// Errors: kUnreachable: the message is a sentence for people that names the address and the step that failed.
[[nodiscard]] boost::asio::awaitable<Result<>> connect(LinkStream& stream, Address address, Endpoints endpoints,
                                                       std::chrono::milliseconds timeout, PeerName peer = {});

/// Resolves the address without blocking, and connects as above.
[[nodiscard]] boost::asio::awaitable<Result<>> connect(LinkStream& stream, Address address,
                                                       std::chrono::milliseconds timeout, PeerName peer = {});

/// Ends the connection when the peer's system has accepted nothing of what was sent for so long: after a loss of power
/// or of the network, and when the peer does not read. Slow networks do not end it. Without effect on systems without
/// such a limit (TCP_USER_TIMEOUT of Linux).
/// @param stream  after connect()
/// Source: RFC 5482.
void set_unconfirmed_max(LinkStream& stream, std::chrono::milliseconds time);

/// Explains to people why a connection failed after connect().
[[nodiscard]] std::string failure_text(const LinkStream& stream, const boost::system::error_code& failed);

/// Awaits `operation` for at most `timeout`, then cancels it.
/// @return the result; nullopt after a timeout
template <class T>
boost::asio::awaitable<std::optional<T>> within(std::chrono::milliseconds timeout,
                                                boost::asio::awaitable<T> operation) {
    using namespace boost::asio::experimental::awaitable_operators;
    boost::asio::steady_timer timer(co_await boost::asio::this_coro::executor, timeout);
    auto first = co_await (std::move(operation) || timer.async_wait(kAwaitTuple));
    if (first.index() != 0) co_return std::nullopt;
    co_return std::optional<T>(std::get<0>(std::move(first)));
}

} // namespace scanloom::net
