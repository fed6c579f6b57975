#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Rules of this source tree that the compiler does not check: which folder may include which, which headers pure
/// folders must not include, and forbidden words. ARCHITECTURE.md describes the folders.
namespace scanloom::tidy {

/// Returns one sentence per violation in a file; empty if there are none.
/// @param path  relative to the root, with slashes: "core/grid/cell.hpp"
[[nodiscard]] std::vector<std::string> complaints_about(std::string_view path, std::string_view text);

} // namespace scanloom::tidy
