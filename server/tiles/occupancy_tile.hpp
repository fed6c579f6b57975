#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/tile_key.hpp"

namespace scanloom::tiles {

/// A tile as 256 x 256 percentages of occupation, 255 unknown, top row first. At coarser zooms each pixel shows,
/// of the cells below it, the one furthest above 50 %, else the lowest known one, else unknown; it is
/// the same whether taken from the cells or from four tiles of the next finer zoom.
///
/// Pre     the tile exists.
/// Cost    follows the chunks that exist in the tile. All tiles that were never touched are one and the same.
/// Thread  any.
[[nodiscard]] SharedBytes occupancy_tile(const mapping::Snapshot& snapshot, TileKey key);

/// The same as an 8-bit grey PNG.
[[nodiscard]] SharedBytes occupancy_tile_png(const mapping::Snapshot& snapshot, TileKey key);

} // namespace scanloom::tiles
