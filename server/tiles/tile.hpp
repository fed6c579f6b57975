#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/tile_key.hpp"

namespace scanloom::tiles {

/// A tile as 256 x 256 codes (see Code), top row first. At coarser zooms each pixel shows the most salient of the
/// cells below it (see style_of()); it is the same whether taken from the cells or from four tiles of the next finer
/// zoom.
///
/// Pre     the tile exists.
/// Cost    follows the chunks that exist in the tile. All tiles of a layer that were never touched are one.
/// Thread  any.
[[nodiscard]] SharedBytes tile_codes(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

/// The same as a PNG in the layer's colours.
[[nodiscard]] SharedBytes tile_png(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

} // namespace scanloom::tiles
