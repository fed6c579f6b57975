#include "server/tiles/changes.hpp"

#include "server/mapping/layer_cells.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace scanloom::tiles {
namespace {

/// Keeps one entry for each tile, with its newest revision, ordered by y, then x.
void merge_equal_tiles(std::vector<ChangedTile>& tiles) {
    std::sort(tiles.begin(), tiles.end(), [](const ChangedTile& a, const ChangedTile& b) {
        return std::tie(a.key.y, a.key.x, b.revision) < std::tie(b.key.y, b.key.x, a.revision);
    });
    const auto same_tile = [](const ChangedTile& a, const ChangedTile& b) { return a.key == b.key; };
    tiles.erase(std::unique(tiles.begin(), tiles.end(), same_tile), tiles.end());
}

} // namespace

std::vector<ChangedTile> changed_native_tiles(const mapping::Snapshot& snapshot, mapping::Layer layer, Revision since) {
    std::vector<ChangedTile> level;
    mapping::with_layer(snapshot, layer, [&](const auto& view, auto&&) {
        view.visit(grid::chunks_of(kTiledCells), since, [&](grid::ChunkKey at, const auto& chunk) {
            const grid::Cell corner{at.ci * grid::kChunkSide, at.cj * grid::kChunkSide};
            level.push_back({tile_of(corner, kZoomNative), chunk.revision});
        });
    });
    merge_equal_tiles(level);
    return level;
}

std::vector<ChangedTile> changed_tiles(const mapping::Snapshot& snapshot, mapping::Layer layer, Revision since) {
    std::vector<ChangedTile> level = changed_native_tiles(snapshot, layer, since);
    std::vector<ChangedTile> all = level;
    for (std::uint32_t zoom = kZoomNative; zoom-- > 0;) {
        for (auto& [key, revision] : level) key = {zoom, key.x / 2, key.y / 2};
        merge_equal_tiles(level);
        std::copy(level.begin(), level.end(), std::back_inserter(all));
    }
    return all;
}

} // namespace scanloom::tiles
