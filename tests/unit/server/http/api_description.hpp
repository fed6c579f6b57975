#pragma once

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

namespace scanloom::http {

/// openapi.json, as the server has it.
[[nodiscard]] const boost::json::value& described_api();

/// What a "$ref" leads to, or the value itself.
[[nodiscard]] const boost::json::object& resolved(const boost::json::value& value);

} // namespace scanloom::http
