#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The rules of this tree that no compiler checks: which folder may include which, what the pure
/// folders must not know, and a few habits. ARCHITECTURE.md gives the reasons.
namespace scanloom::tidy {

/// What is wrong with one file, a sentence each; empty: nothing.
/// @param path  relative to the root, with slashes: "server/grid/cell.hpp"
[[nodiscard]] std::vector<std::string> complaints_about(std::string_view path, std::string_view text);

} // namespace scanloom::tidy
