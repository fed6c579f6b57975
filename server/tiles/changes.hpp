#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/tile_key.hpp"

#include <vector>

namespace scanloom::tiles {

struct ChangedTile {
    TileKey key;
    Revision revision = 0; ///< as tile_revision()

    friend bool operator==(const ChangedTile&, const ChangedTile&) = default;
};

/// Every tile of a layer, of every zoom, that was touched after a revision; after 0: every tile ever touched.
/// Ordered by falling zoom, then y, then x.
/// Cost    follows the chunks that changed, not the map.
[[nodiscard]] std::vector<ChangedTile> changed_tiles(const mapping::Snapshot& snapshot, mapping::Layer layer,
                                                     Revision since);

/// Those of kZoomNative among them. Ordered by y, then x.
[[nodiscard]] std::vector<ChangedTile> changed_native_tiles(const mapping::Snapshot& snapshot, mapping::Layer layer,
                                                            Revision since);

} // namespace scanloom::tiles
