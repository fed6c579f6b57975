#pragma once

#include "server/http/request.hpp"

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include <string_view>

/// Beast's messages as our requests.
namespace scanloom::http {

using Incoming = boost::beast::http::request<boost::beast::http::string_body>;

[[nodiscard]] inline std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// What tells the lane, and who asks: all but the body and what conditions it has.
[[nodiscard]] Request head_of(const Incoming& message);

/// Takes the body out of the message.
[[nodiscard]] Request request_of(Incoming& message);

} // namespace scanloom::http
