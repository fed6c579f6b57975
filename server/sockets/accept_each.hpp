#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <functional>
#include <string_view>

namespace scanloom::sockets {

/// Accepts connections until the acceptor is closed. Passes each socket to `take`; the socket's executor is a new
/// strand.
///
/// A failure of accepting or of `take` is logged, loses one connection, and is followed by a pause of 100 ms in which
/// memory or descriptors may be released.
/// @param what  kind of peer, for the log ("a robot")
/// @param take  called on the acceptor's executor
/// Pre: acceptor, io and everything that `take` refers to outlive the coroutine.
/// Threads: spawn it on the acceptor's executor.
[[nodiscard]] boost::asio::awaitable<void> accept_each(boost::asio::ip::tcp::acceptor& acceptor,
                                                       boost::asio::io_context& io, std::string_view what,
                                                       std::function<void(boost::asio::ip::tcp::socket)> take);

} // namespace scanloom::sockets
