#pragma once

#include "core/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/tile_key.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::tiles {

/// Version of the rendering of tiles and map files. Increase it when the same snapshot gives other bytes, so that
/// caches discard what an older program drew.
inline constexpr std::uint32_t kRenderingVersion = 5;

/// Returns the revision of the newest change of any of the tile's cells in the layer; 0 if none ever changed. Changes
/// elsewhere do not affect it.
[[nodiscard]] Revision tile_revision(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key);

/// Returns a strong entity tag, quoted: equal tags mean equal bytes.
/// @param session_tag  differs between any two sessions, even if they have the same name one after the other, and
///                     between program versions that map or draw differently
[[nodiscard]] std::string etag_of(std::string_view session_tag, std::string_view layer, TileKey key,
                                  Revision tile_revision);

/// A tile that changed.
struct ChangedTile {
    TileKey key;
    Revision revision = 0; ///< see tile_revision()

    friend bool operator==(const ChangedTile&, const ChangedTile&) = default;
};

/// Returns all tiles of a layer, of every zoom, that changed after revision `since`; with 0, all tiles that ever
/// changed. Ordered by decreasing zoom, then y, then x.
/// Cost: proportional to the chunks that changed, independent of the map's size.
[[nodiscard]] std::vector<ChangedTile> changed_tiles(const mapping::Snapshot& snapshot, mapping::Layer layer,
                                                     Revision since);

/// Returns the tiles of zoom kZoomNative that changed after revision `since`. Ordered by y, then x.
[[nodiscard]] std::vector<ChangedTile> changed_native_tiles(const mapping::Snapshot& snapshot, mapping::Layer layer,
                                                            Revision since);

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
