#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace scanloom::tiles {

using Bytes = std::vector<std::uint8_t>;

/// Immutable bytes that several responses may share.
using SharedBytes = std::shared_ptr<const Bytes>;

} // namespace scanloom::tiles
