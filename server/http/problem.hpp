#pragma once

#include "common/error/error.hpp"
#include "server/http/response.hpp"

#include <boost/json/object.hpp>

#include <string_view>

namespace scanloom::http {

/// The status that stands for a kind of failure: the one table of it.
[[nodiscard]] Status status_of(Errc code) noexcept;

/// A failure as application/problem+json: type "urn:scanloom:error:" + name_of(code), the message as
/// detail, the path that was asked for as instance.
/// Source  RFC 9457.
[[nodiscard]] Response problem(const Error& error, std::string_view path);

/// A failure of HTTP itself, whose status says it all; type "about:blank".
/// `extensions` are members besides those of the RFC.
[[nodiscard]] Response problem(Status status, std::string_view detail, std::string_view path,
                               const boost::json::object& extensions = {});

/// The path of a request target, cut short and cleaned for Problem's "instance".
[[nodiscard]] std::string instance_of(std::string_view target);

} // namespace scanloom::http
