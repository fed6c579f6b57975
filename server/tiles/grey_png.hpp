#pragma once

#include "server/tiles/bytes.hpp"
#include "server/tiles/occupancy_percent.hpp"

#include <span>

namespace scanloom::tiles {

/// An 8-bit grey PNG of occupancy: white free, black occupied, mid-grey (128) unknown.
/// Shapes  width * height percentages, top row first.
/// Pre     0 < width, height <= 1,000,000: what libpng writes.
[[nodiscard]] Bytes grey_png(std::span<const Percent> pixels, std::int32_t width, std::int32_t height);

} // namespace scanloom::tiles
