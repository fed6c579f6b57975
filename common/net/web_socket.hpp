#pragma once

#include "common/net/link_stream.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>

#include <span>
#include <string>

namespace scanloom::net {

/// A WebSocket over a LinkStream, without compression (false).
using WebSocket = boost::beast::websocket::stream<LinkStream, false>;

// Operations that wait. They are Beast's, compiled once, in web_socket.cpp: each file that uses the templates
// themselves takes several seconds more to compile.
// Threads: as for LinkStream.

/// Accepts a client, whose request to upgrade was read.
[[nodiscard]] boost::asio::awaitable<boost::system::error_code>
accept(WebSocket& socket, const boost::beast::http::request<boost::beast::http::string_body>& upgrade);

/// Requests a server to upgrade.
/// @param answer  receives the server's answer
/// @param host    for the Host field
/// @param target  path and query
[[nodiscard]] boost::asio::awaitable<boost::system::error_code>
shake_hands(WebSocket& socket, boost::beast::websocket::response_type& answer, const std::string& host,
            const std::string& target);

/// Appends the next message to `message`.
[[nodiscard]] boost::asio::awaitable<boost::system::error_code> read(WebSocket& socket,
                                                                     boost::beast::flat_buffer& message);

/// Sends a message.
/// @param parts  its bytes
[[nodiscard]] boost::asio::awaitable<boost::system::error_code> write(WebSocket& socket,
                                                                      std::span<const boost::asio::const_buffer> parts);

/// Closes the connection, and waits for the peer to do so.
[[nodiscard]] boost::asio::awaitable<boost::system::error_code>
close(WebSocket& socket, const boost::beast::websocket::close_reason& reason);

} // namespace scanloom::net
