#include "server/tiles/tile.hpp"

#include "server/mapping/layer_cells.hpp"
#include "server/tiles/chunk_reduction.hpp"
#include "server/tiles/png.hpp"
#include "server/tiles/tile_version.hpp"

#include <algorithm>
#include <array>

namespace scanloom::tiles {
namespace {

constexpr std::size_t kTilePixels = std::size_t{kTileSide} * kTileSide;

/// The tile of a layer that nothing has touched.
struct Untouched {
    SharedBytes codes;
    SharedBytes png;
};

SharedBytes png_of_tile(const Bytes& tile, mapping::Layer layer) {
    return std::make_shared<const Bytes>(png_of(tile, kTileSide, kTileSide, style_of(layer)));
}

const Untouched& untouched(mapping::Layer layer) {
    static const auto all = [] {
        std::array<Untouched, mapping::kLayers.size()> tiles;
        for (const mapping::Layer each : mapping::kLayers) {
            const auto codes = std::make_shared<const Bytes>(kTilePixels, style_of(each).unknown);
            tiles[static_cast<std::size_t>(each)] = {codes, png_of_tile(*codes, each)};
        }
        return tiles;
    }();
    return all[static_cast<std::size_t>(layer)];
}

/// Merges a chunk into the saliences of a tile that contains it.
void draw(Bytes& tile, const grid::CellBox& cells, std::int32_t scale, grid::ChunkKey at, const ReducedChunk& reduced) {
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

SharedBytes tile_codes(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key) {
    if (tile_revision(snapshot, layer, key) == 0) return untouched(layer).codes;
    const auto cells = cells_of(key);
    const std::int32_t scale = cells_per_pixel(key.zoom);
    Bytes tile(kTilePixels, kUnknownSalience);
    mapping::with_layer(snapshot, layer, [&](const auto& view, auto&& cells_of_chunk) {
        view.visit(grid::chunks_of(cells), 0, [&](grid::ChunkKey at, const auto& chunk) {
            draw(tile, cells, scale, at, reduce(cells_of_chunk(chunk), std::min(scale, grid::kChunkSide)));
        });
    });
    const auto& style = style_of(layer);
    std::ranges::transform(tile, tile.begin(), [&](Salience salience) { return style.code[salience]; });
    return std::make_shared<const Bytes>(std::move(tile));
}

SharedBytes tile_png(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key) {
    const auto tile = tile_codes(snapshot, layer, key);
    return tile == untouched(layer).codes ? untouched(layer).png : png_of_tile(*tile, layer);
}

} // namespace scanloom::tiles
