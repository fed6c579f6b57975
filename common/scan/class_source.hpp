#pragma once

#include <cstdint>

namespace scanloom {

/// Which layer tells free cells from occupied ones.
enum class ClassSource : std::uint8_t { kOccupancy, kHimm };

} // namespace scanloom
