#pragma once

#include "common/net/link_stream.hpp"

#include <boost/beast/core/role.hpp>

#include <utility>

/// What a WebSocket of Beast looks for beside the stream that it goes over (argument-dependent lookup).
namespace scanloom::net {

/// Closes the connection in good order.
template <class Handler>
void async_teardown(boost::beast::role_type role, LinkStream& stream, Handler&& handler) {
    stream.async_teardown(role, std::forward<Handler>(handler));
}

/// Closes it when the WebSocket's patience is over.
inline void beast_close_socket(LinkStream& stream) { stream.close(); }

} // namespace scanloom::net
