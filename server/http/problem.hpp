#pragma once

#include "common/error/error.hpp"
#include "server/http/response.hpp"

#include <boost/json/object.hpp>

#include <string_view>

namespace scanloom::http {

/// Returns the HTTP status of an error code. This is the only such table.
[[nodiscard]] Status status_of(Errc code) noexcept;

/// Returns an error as application/problem+json: type "urn:scanloom:error:" + name_of(code), the message as detail, the
/// requested path as instance.
/// Source: RFC 9457.
[[nodiscard]] Response problem(const Error& error, std::string_view path);

/// Returns an error of HTTP itself, which its status describes completely, with type "about:blank".
/// @param extensions  members in addition to those of the RFC
[[nodiscard]] Response problem(Status status, std::string_view detail, std::string_view path,
                               const boost::json::object& extensions = {});

/// Returns the path of a request target for the "instance" of a problem, shortened and with unsafe characters replaced.
[[nodiscard]] std::string instance_of(std::string_view target);

} // namespace scanloom::http
