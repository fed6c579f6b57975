#include "server/tiles/occupancy_tile.hpp"

#include "server/tiles/chunk_reduction.hpp"
#include "server/tiles/grey_png.hpp"
#include "server/tiles/tile_version.hpp"

#include <algorithm>

namespace scanloom::tiles {
namespace {

constexpr std::size_t kTilePixels = std::size_t{kTileSide} * kTileSide;

SharedBytes png_of(const Bytes& tile) { return std::make_shared<const Bytes>(grey_png(tile, kTileSide, kTileSide)); }

const SharedBytes& untouched_tile() {
    static const SharedBytes tile = std::make_shared<const Bytes>(kTilePixels, kUnknownPercent);
    return tile;
}

const SharedBytes& untouched_tile_png() {
    static const SharedBytes png = png_of(*untouched_tile());
    return png;
}

/// Merges a chunk into the saliences of a tile that contains it.
void draw(Bytes& tile, const grid::CellBox& cells, std::int32_t scale, grid::ChunkKey at,
          const mapping::OccupancyChunk& chunk) {
    const auto reduced = reduce(chunk, std::min(scale, grid::kChunkSide));
    const std::int32_t left = (at.ci * grid::kChunkSide - cells.i_begin) / scale;
    const std::int32_t bottom = (cells.j_end - 1 - at.cj * grid::kChunkSide) / scale;
    for (std::int32_t row = 0; row < reduced.side; ++row) {
        auto* pixel = &tile[static_cast<std::size_t>((bottom - row) * kTileSide + left)];
        for (std::int32_t column = 0; column < reduced.side; ++column, ++pixel) {
            *pixel = std::max(*pixel, reduced.at(column, row)); // below zoom 3 chunks share a pixel
        }
    }
}

} // namespace

SharedBytes occupancy_tile(const mapping::Snapshot& snapshot, TileKey key) {
    if (tile_revision(snapshot, key) == 0) return untouched_tile();
    const auto cells = cells_of(key);
    Bytes tile(kTilePixels, kUnknownSalience);
    snapshot.occupancy.visit(grid::chunks_of(cells), 0, [&](grid::ChunkKey at, const mapping::OccupancyChunk& chunk) {
        draw(tile, cells, cells_per_pixel(key.zoom), at, chunk);
    });
    std::transform(tile.begin(), tile.end(), tile.begin(), percent_of_salience);
    return std::make_shared<const Bytes>(std::move(tile));
}

SharedBytes occupancy_tile_png(const mapping::Snapshot& snapshot, TileKey key) {
    const auto tile = occupancy_tile(snapshot, key);
    return tile == untouched_tile() ? untouched_tile_png() : png_of(*tile);
}

} // namespace scanloom::tiles
