#pragma once

#include "common/error/error.hpp"

#include <boost/json/object.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Whether a Content-Type field says JSON, with any parameters.
[[nodiscard]] bool is_json(std::string_view content_type);

/// The JSON object that a body is, at most 8 levels deep.
/// Errors  kMalformed: not JSON, deeper, or not an object. kInvalidField: a key that is given twice.
[[nodiscard]] Result<boost::json::object> parse_json_object(std::string_view body);

/// Errors  kInvalidField, naming the first member that is none of these.
[[nodiscard]] Result<> check_members(const boost::json::object& object, std::span<const std::string_view> known);

/// Errors  kInvalidField, naming the member: absent, or no string.
[[nodiscard]] Result<std::string> read_text(const boost::json::object& object, std::string_view name);

/// Nothing when the member is absent.
/// Errors  kInvalidField, naming the member: no number, or one too large for a double.
[[nodiscard]] Result<std::optional<double>> read_number(const boost::json::object& object, std::string_view name);

} // namespace scanloom::http
