#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/tile_key.hpp"

#include <vector>

namespace scanloom::tiles {

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

} // namespace scanloom::tiles
