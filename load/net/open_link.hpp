#pragma once

#include "common/net/link_stream.hpp"
#include "load/net/http_place.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <string>

namespace scanloom::load {

/// A connection to the HTTP port that is not open yet.
[[nodiscard]] net::LinkStream link_to(const HttpPlace& place, const boost::asio::any_io_executor& executor);

/// Connects, and shakes hands where the place has TLS. Both stay until this is done.
[[nodiscard]] boost::asio::awaitable<boost::system::error_code> open_link(net::LinkStream& stream,
                                                                          const HttpPlace& place);

/// Why the link failed, for people.
[[nodiscard]] std::string trouble_with(const net::LinkStream& stream, const boost::system::error_code& failed);

} // namespace scanloom::load
