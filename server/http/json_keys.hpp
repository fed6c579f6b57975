#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Returns the first key that occurs twice in one object of `json`, at any depth, or nullopt. A parser that keeps the
/// last of two values would silently ignore the first one.
/// @param json  well-formed; of malformed text, only the part before the error is checked
[[nodiscard]] std::optional<std::string> duplicate_key(std::string_view json);

} // namespace scanloom::http
