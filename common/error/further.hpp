#pragma once

#include <string>
#include <string_view>

namespace scanloom {

/// Joins a message and what follows from it: "it is gone; trying again". After a question, `more` becomes a sentence of
/// its own: "is it gone? Trying again".
[[nodiscard]] std::string further(std::string_view message, std::string_view more);

} // namespace scanloom
