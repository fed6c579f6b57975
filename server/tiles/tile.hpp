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

/// The tile of a layer that nothing has touched, of every place; always the same bytes.
[[nodiscard]] SharedBytes untouched_codes(mapping::Layer layer);

/// A tile as it was drawn from earlier maps.
struct DrawnTile {
    SharedBytes codes;
    Revision revision = 0; ///< tile_revision() in those maps
};

/// The same from an earlier drawing of the tile: only what changed since is drawn.
///
/// Pre     `earlier` is of the same layer and tile of the same maps, and not newer than the snapshot.
/// Cost    follows the chunks that changed in the tile; below zoom 3, where up to 64 chunks share a pixel, also those
///         that share one with them. Not the map, but for a copy of the tile.
[[nodiscard]] SharedBytes tile_codes(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key,
                                     const DrawnTile& earlier);

/// Codes as a PNG in the layer's colours, with a palette of those that occur. That of untouched_codes() is made once.
[[nodiscard]] SharedBytes tile_png(const SharedBytes& codes, mapping::Layer layer);

/// From nothing.
[[nodiscard]] SharedBytes tile_png(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

} // namespace scanloom::tiles
