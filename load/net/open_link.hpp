#pragma once

#include "common/net/link_stream.hpp"
#include "load/net/http_place.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <string>

namespace scanloom::load {

/// Returns a connection to the HTTP port that is not open yet.
[[nodiscard]] net::LinkStream link_to(const HttpPlace& place, const boost::asio::any_io_executor& executor);

/// Connects, and performs the TLS handshake if the place has TLS. Both arguments must outlive the call.
[[nodiscard]] boost::asio::awaitable<boost::system::error_code> open_link(net::LinkStream& stream,
                                                                          const HttpPlace& place);

/// Returns for people why the link failed.
[[nodiscard]] std::string trouble_with(const net::LinkStream& stream, const boost::system::error_code& failed);

} // namespace scanloom::load
