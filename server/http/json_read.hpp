#pragma once

#include "common/error/error.hpp"

#include <boost/json/object.hpp>

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Returns whether a Content-Type field denotes JSON, with any parameters.
[[nodiscard]] bool is_json(std::string_view content_type);

/// Parses a body as a JSON object of at most 8 levels.
/// Errors: kMalformed if it is not JSON, deeper, or not an object; kInvalidField if a key is given twice.
[[nodiscard]] Result<boost::json::object> parse_json_object(std::string_view body);

/// Parses a body as a JSON object that has no other members than `known`.
/// Errors: those of parse_json_object(body) and check_members().
[[nodiscard]] Result<boost::json::object> parse_json_object(std::string_view body,
                                                            std::span<const std::string_view> known);
[[nodiscard]] inline Result<boost::json::object> parse_json_object(std::string_view body,
                                                                   std::initializer_list<std::string_view> known) {
    return parse_json_object(body, std::span(known.begin(), known.size()));
}

/// Returns the first key that occurs twice in one object of `json`, at any depth, or nullopt. A parser that keeps the
/// last of two values would silently ignore the first one.
/// @param json  well-formed; of malformed text, only the part before the error is checked
[[nodiscard]] std::optional<std::string> duplicate_key(std::string_view json);

/// Errors: kInvalidField, naming the first member that is not in `known`.
[[nodiscard]] Result<> check_members(const boost::json::object& object, std::span<const std::string_view> known);

/// Errors: kInvalidField, naming the member, if it is absent or not a string.
[[nodiscard]] Result<std::string> read_text(const boost::json::object& object, std::string_view name);

/// Returns the member's value, or nullopt if it is absent.
/// Errors: kInvalidField, naming the member, if it is not a number or too large for a double.
[[nodiscard]] Result<std::optional<double>> read_number(const boost::json::object& object, std::string_view name);

/// Returns the member's value, or nullopt if it is absent.
/// Errors: kInvalidField, naming the member, if it is neither true nor false.
[[nodiscard]] Result<std::optional<bool>> read_flag(const boost::json::object& object, std::string_view name);

} // namespace scanloom::http
