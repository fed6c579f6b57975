#pragma once

#include "server/tiles/bytes.hpp"
#include "server/tiles/layer_style.hpp"

#include <span>

namespace scanloom::tiles {

/// A PNG in the colours of the layer: 8-bit grey where all of them are, else 8-bit RGB.
/// Shapes  width * height codes, top row first.
/// Pre     0 < width, height <= 1,000,000: what libpng writes.
[[nodiscard]] Bytes png_of(std::span<const Code> codes, std::int32_t width, std::int32_t height,
                           const LayerStyle& style);

} // namespace scanloom::tiles
