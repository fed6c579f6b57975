#pragma once

#include "server/http/api.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/server_config.hpp"

#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include <cstdint>
#include <optional>
#include <string_view>

/// Requests as Beast reads them: their conversion to Request, and the refusal of bytes that are not a request and of
/// requests whose body is not worth reading.
namespace scanloom::http {
using Incoming = boost::beast::http::request<boost::beast::http::string_body>;

[[nodiscard]] inline std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// Returns the request without its body, If-None-Match and Accept-Encoding: enough for the route and the permission.
[[nodiscard]] Request head_of(const Incoming& message);

/// Adds the rest to head_of(message): the body, which is moved, If-None-Match and Accept-Encoding.
void read_rest(Incoming& message, Request& request);

using Parser = boost::beast::http::request_parser<boost::beast::http::string_body>;

/// Returns whether the bytes begin with a TLS handshake record (RFC 8446, section 5.1).
[[nodiscard]] bool is_tls_hello(const boost::beast::flat_buffer& unread);

/// Returns the response to bytes that cannot be parsed as a request, or nullopt if a response is not possible.
/// @param reason  why parsing failed
[[nodiscard]] std::optional<Response> refusal_of(const boost::beast::flat_buffer& unread,
                                                 boost::beast::error_code reason);

/// Returns the maximum size of a request's body, in bytes.
/// @param routed  null if the request has no route
[[nodiscard]] std::uint64_t body_bytes_max(const Api::Routed* routed, const ServerConfig& config);

/// Returns the refusal of a request after reading only its header, or nullopt. Writes requests for a foreign host to
/// the audit log.
/// @param head       the request in `parser`
/// @param bytes_max  maximum size of its body
[[nodiscard]] std::optional<Response> refusal_of(const Parser& parser, const Request& head, std::uint64_t bytes_max,
                                                 const Service& service);

} // namespace scanloom::http
