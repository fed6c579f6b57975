#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/tile_key.hpp"

namespace scanloom::tiles {

/// Draws a tile as 256 x 256 codes (see Code), top row first.
///
/// At coarser zooms, each pixel shows the most salient of its cells (see style_of()). The result is the same whether
/// computed from the cells or from four tiles of the next finer zoom. All tiles of a layer that never changed share
/// their bytes.
/// Precondition: the tile exists.
/// Cost: proportional to the chunks that exist in the tile.
/// Threads: any thread.
[[nodiscard]] SharedBytes tile_codes(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

/// Returns the codes of every tile of a layer that never changed; always the same bytes.
[[nodiscard]] SharedBytes untouched_codes(mapping::Layer layer);

/// A tile drawn from an earlier snapshot.
struct DrawnTile {
    SharedBytes codes;
    Revision revision = 0; ///< tile_revision() in that snapshot
};

/// Draws a tile from an earlier drawing by drawing only what changed since.
/// @param earlier  a drawing of the same tile and layer of the same maps, not newer than the snapshot
/// Precondition: the tile exists.
/// Cost: a copy of the tile, and the chunks that changed in it; below zoom 3, where up to 64 chunks share a pixel, also
///       the chunks that share a pixel with them. Independent of the map's size.
/// Threads: any thread.
[[nodiscard]] SharedBytes tile_codes(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key,
                                     const DrawnTile& earlier);

/// Encodes codes as a PNG in the layer's colours, with a palette of the codes that occur. The PNG of untouched_codes()
/// is encoded once.
[[nodiscard]] SharedBytes tile_png(const SharedBytes& codes, mapping::Layer layer);

/// Draws and encodes a tile without an earlier drawing.
[[nodiscard]] SharedBytes tile_png(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

} // namespace scanloom::tiles
