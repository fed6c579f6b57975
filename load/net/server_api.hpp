#pragma once

#include "common/error/error.hpp"
#include "common/net/http_connection.hpp"
#include "load/core/figures.hpp"
#include "load/core/tile_tour.hpp"
#include "load/core/verdict.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::load {

// Requests over HTTP, except for tiles. Each fails as net::HttpConnection::ask() does, and with refusal() if the answer
// is not 200 or not what the API specifies.

/// Returns the names of the sessions that begin with `prefix`.
[[nodiscard]] boost::asio::awaitable<Result<std::vector<std::string>>> sessions_of(net::HttpConnection& http,
                                                                                   std::string prefix);
[[nodiscard]] boost::asio::awaitable<Result<FoundSession>> find_session(net::HttpConnection& http, std::string session);
/// Returns the digests of all layers as one text.
[[nodiscard]] boost::asio::awaitable<Result<std::string>> digest_of(net::HttpConnection& http, std::string session);
/// Succeeds if there is no such session.
[[nodiscard]] boost::asio::awaitable<Result<>> delete_session(net::HttpConnection& http, std::string session);
[[nodiscard]] boost::asio::awaitable<Result<ServerUse>> server_use(net::HttpConnection& http);
/// Returns the tiles of zoom 9 that were ever changed.
[[nodiscard]] boost::asio::awaitable<Result<std::vector<TilePlace>>> tiles_of(net::HttpConnection& http,
                                                                              std::string session, std::string layer);

/// Returns an answer with an unexpected status as an error.
[[nodiscard]] Error refusal(const net::HttpAnswer& answer, const std::string& target);

/// Reads a value of the Prometheus text format; 0 if there is none with this name.
[[nodiscard]] double metric(std::string_view text, std::string_view name);

} // namespace scanloom::load
