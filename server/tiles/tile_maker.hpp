#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/tile_cache.hpp"

#include <cstddef>
#include <memory>
#include <string_view>

namespace scanloom::tiles {

/// Maps whose tiles are made.
struct TileSource {
    const mapping::Snapshot& snapshot;
    std::shared_ptr<const void> origin; ///< whatever makes them, a session or a weave: its snapshots follow each other
};

/// The tiles of all maps: each drawn and encoded once for each of its revisions, as long as there is room.
///
/// Of tiles that show many chunks also the drawing is kept, from which the next revision differs by the chunks that
/// changed: so the whole pyramid follows a growing map at the cost of the change, whatever the extent.
/// Memory  see TileCache.
/// Thread  any.
class TileMaker {
public:
    /// In a map that grows in view of somebody, the tiles in view of the coarser zooms take 1 MiB.
    static constexpr std::size_t kBytesMax = std::size_t{64} << 20;

    explicit TileMaker(std::size_t bytes_max = kBytesMax) : cache_(bytes_max) {}

    /// The tile if it is there, in microseconds; else null.
    /// Pre  here and below: `revision` is the tile's tile_revision() in its maps.
    [[nodiscard]] SharedBytes find(const TilePlace& place, Revision revision);

    /// Whether making it takes no look at a whole map: it shows no more than a part of one, or an earlier drawing is
    /// there to go on from. `origin` as in TileSource; a later revision than the tile's does for it.
    [[nodiscard]] bool is_quick(const std::shared_ptr<const void>& origin, const TilePlace& place, Revision revision);

    /// The tile, made if it is not there; who asks for one that is being made waits for it.
    /// Pre  the maps are those that place.maps names.
    [[nodiscard]] SharedBytes make(const TileSource& maps, const TilePlace& place, Revision revision);

    /// See TileCache::forget().
    void forget(std::string_view maps) { cache_.forget(maps); }

    [[nodiscard]] TileCache::Stats stats() const { return cache_.stats(); }

private:
    [[nodiscard]] KeptTile earlier_drawing(const std::shared_ptr<const void>& origin, const TilePlace& codes,
                                           Revision revision);
    [[nodiscard]] KeptTile draw(const TileSource& maps, const TilePlace& codes, Revision revision);

    TileCache cache_;
};

} // namespace scanloom::tiles
