#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <functional>
#include <string_view>

namespace scanloom::sockets {

/// Accepts until the acceptor is closed, and hands over each socket, which has a strand of its own as its executor.
///
/// Whatever fails, accepting or `take`, costs one connection and a short pause, in which memory or descriptors may come
/// free; it is logged, with `what` it was ("a robot").
/// Pre     acceptor, io and what `take` refers to outlive the coroutine.
/// Thread  to be spawned on the acceptor's executor; `take` is called there.
[[nodiscard]] boost::asio::awaitable<void> accept_each(boost::asio::ip::tcp::acceptor& acceptor,
                                                       boost::asio::io_context& io, std::string_view what,
                                                       std::function<void(boost::asio::ip::tcp::socket)> take);

} // namespace scanloom::sockets
