#pragma once

#include "common/net/link_stream.hpp"

#include <boost/beast/core/role.hpp>

#include <utility>

/// Functions that Beast's WebSocket finds for its stream type by argument-dependent lookup.
namespace scanloom::net {

/// Closes the connection in an orderly way.
template <class Handler>
void async_teardown(boost::beast::role_type role, LinkStream& stream, Handler&& handler) {
    stream.async_teardown(role, std::forward<Handler>(handler));
}

/// Closes the connection at once, when a timeout of the WebSocket expires.
inline void beast_close_socket(LinkStream& stream) { stream.close(); }

} // namespace scanloom::net
