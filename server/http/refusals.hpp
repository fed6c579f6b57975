#pragma once

#include "server/http/incoming.hpp"
#include "server/http/response.hpp"
#include "server/http/service.hpp"

#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>

#include <cstdint>
#include <optional>
#include <string>

/// What a connection answers before anybody is asked: to bytes that are no request, and to requests whose body is
/// not worth reading.
namespace scanloom::http {

using Parser = boost::beast::http::request_parser<boost::beast::http::string_body>;

/// Whether they begin as TLS does: with a record of a handshake (RFC 8446, section 5.1).
[[nodiscard]] bool is_tls_hello(const boost::beast::flat_buffer& unread);

/// The answer to bytes that cannot be read as a request for this reason; nothing when there is nobody to answer.
[[nodiscard]] std::optional<Response> refusal_of(const boost::beast::flat_buffer& unread,
                                                 boost::beast::error_code reason);

/// Returns how many bytes of body a request may have.
[[nodiscard]] std::uint64_t body_bytes_max(const Request& head, const ServerConfig& config);

/// What is wrong with a request whose header alone has been read. Who asks for a foreign host is told of.
/// @param peer  the address that it comes from.
[[nodiscard]] std::optional<Response> refusal_of(const Parser& parser, const Service& service, const std::string& peer);

} // namespace scanloom::http
