#pragma once

#include <cstdint>

namespace scanloom {

/// The layer that decides which cells are free and which are occupied.
enum class ClassSource : std::uint8_t { kOccupancy, kHimm };

} // namespace scanloom
