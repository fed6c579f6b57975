#pragma once

#include "server/http/request.hpp"

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include <string_view>

/// Conversion of Beast's messages to Request.
namespace scanloom::http {

using Incoming = boost::beast::http::request<boost::beast::http::string_body>;

[[nodiscard]] inline std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// Returns the request without its body, If-None-Match and Accept-Encoding: enough for the route and the permission.
[[nodiscard]] Request head_of(const Incoming& message);

/// Adds the rest to head_of(message): the body, which is moved, If-None-Match and Accept-Encoding.
void read_rest(Incoming& message, Request& request);

} // namespace scanloom::http
