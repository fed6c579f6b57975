#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scanloom::http {

/// The first key that an object of this JSON has twice, at any depth; nothing when there is none. A parser that keeps
/// the last of two would hide from whoever wrote the first that it does not count.
/// Pre  well-formed JSON; of other text, what comes before the fault.
[[nodiscard]] std::optional<std::string> duplicate_key(std::string_view json);

} // namespace scanloom::http
