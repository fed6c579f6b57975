#pragma once

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

namespace scanloom::http {

/// Returns openapi().
[[nodiscard]] const boost::json::value& described_api();

/// Returns the target of a "$ref", or the value itself.
[[nodiscard]] const boost::json::object& resolved(const boost::json::value& value);

} // namespace scanloom::http
