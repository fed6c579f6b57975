#pragma once

#include "core/mapping/snapshot.hpp"
#include "server/tiles/tile_cache.hpp"

#include <cstddef>
#include <memory>
#include <string_view>

namespace scanloom::tiles {

/// The maps whose tiles are made.
struct TileSource {
    const mapping::Snapshot& snapshot;
    std::shared_ptr<const void> origin; ///< session or replay job of the maps; its snapshots follow each other
};

/// Makes and caches the tiles of all maps. Each revision of a tile is drawn and encoded once, as long as the cache has
/// space.
///
/// For tiles that show many chunks, the cache also keeps the drawing. The next revision is drawn from it by drawing the
/// chunks that changed. The tiles of all zooms therefore follow a growing map at a cost proportional to the change,
/// independent of the map's size.
/// Memory: see TileCache.
/// Threads: any thread.
class TileMaker {
public:
    /// Default size of the cache. For one viewer of a growing map, the visible tiles of the coarser zooms take 1 MiB.
    static constexpr std::size_t kBytesMax = std::size_t{64} << 20;

    explicit TileMaker(std::size_t bytes_max = kBytesMax) : cache_(bytes_max) {}

    /// Returns the tile if it is cached, or null. Takes microseconds.
    /// @param revision  the tile's tile_revision() in its maps
    [[nodiscard]] SharedBytes find(const TilePlace& place, Revision revision);

    /// Returns whether the tile can be made without reading a whole map: it shows only a part of one, or an earlier
    /// drawing is cached to start from.
    /// @param origin  see TileSource
    /// @param revision  the tile's tile_revision() in its maps, or a later revision
    [[nodiscard]] bool is_quick(const std::shared_ptr<const void>& origin, const TilePlace& place, Revision revision);

    /// Returns the tile; makes it if it is not cached. If the tile is already being made, waits for it.
    /// @param maps  the maps that place.maps names
    /// @param revision  the tile's tile_revision() in these maps
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
