#include "server/tiles/tile.hpp"

#include "core/mapping/snapshot.hpp"
#include "server/tiles/chunk_reduction.hpp"
#include "server/tiles/png.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <tuple>
#include <vector>

namespace scanloom::tiles {

Revision tile_revision(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key) {
    return mapping::with_layer(snapshot, layer,
                               [&](const auto& view, auto&&) { return view.newest(grid::chunks_of(cells_of(key))); });
}

std::string etag_of(std::string_view session_tag, std::string_view layer, TileKey key, Revision tile_revision) {
    return fmt::format("\"{}-{}-{}-{}-{}-{}\"", session_tag, layer, key.zoom, key.x, key.y, tile_revision);
}

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

namespace {

constexpr std::size_t kTilePixels = std::size_t{kTileSide} * kTileSide;

/// The tile of a layer at places that never changed.
struct Untouched {
    SharedBytes codes;
    SharedBytes png;
};

SharedBytes png_of(const Bytes& tile, mapping::Layer layer) {
    return std::make_shared<const Bytes>(palette_png(tile, kTileSide, kTileSide, style_of(layer)));
}

const Untouched& untouched(mapping::Layer layer) {
    static const auto all = [] {
        std::array<Untouched, mapping::kLayers.size()> tiles;
        for (const mapping::Layer each : mapping::kLayers) {
            const auto codes = std::make_shared<const Bytes>(kTilePixels, style_of(each).unknown);
            tiles[static_cast<std::size_t>(each)] = {codes, png_of(*codes, each)};
        }
        return tiles;
    }();
    return all[static_cast<std::size_t>(layer)];
}

/// A tile's codes while chunks are drawn on them.
class Canvas {
public:
    Canvas(Bytes codes, TileKey key, const LayerStyle& style)
        : codes_(std::move(codes)), cells_(cells_of(key)), scale_(cells_per_pixel(key.zoom)), style_(style) {}

    /// Draws the whole tile.
    template <class View, class CellsOf>
    void draw(const View& view, CellsOf&& cells_of_chunk) {
        draw_region(view, cells_of_chunk, grid::chunks_of(cells_));
    }

    /// Draws the chunks that changed after `since`.
    template <class View, class CellsOf>
    void draw_changes(const View& view, CellsOf&& cells_of_chunk, Revision since) {
        const std::int32_t shared = std::max(1, scale_ / grid::kChunkSide); // chunks along a pixel's side, a power of 2
        std::vector<grid::ChunkKey> corners;
        view.visit(grid::chunks_of(cells_), since, [&](grid::ChunkKey at, const auto&) {
            corners.push_back({at.cj & ~(shared - 1), at.ci & ~(shared - 1)});
        });
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        for (const auto& [cj, ci] : corners) {
            draw_region(view, cells_of_chunk, {ci, cj, std::int64_t{ci} + shared, std::int64_t{cj} + shared});
        }
    }

    [[nodiscard]] Bytes take() { return std::move(codes_); }

private:
    /// Draws the chunks of a region again. No chunk outside the region may share a pixel with it. The region's pixels
    /// hold saliences until all chunks are drawn.
    template <class View, class CellsOf>
    void draw_region(const View& view, CellsOf&& cells_of_chunk, const grid::ChunkBox& region) {
        const auto left = static_cast<std::int32_t>(region.ci_begin * grid::kChunkSide - cells_.i_begin) / scale_;
        const auto top = static_cast<std::int32_t>(cells_.j_end - region.cj_end * grid::kChunkSide) / scale_;
        const auto width = static_cast<std::int32_t>((region.ci_end - region.ci_begin) * grid::kChunkSide) / scale_;
        const auto height = static_cast<std::int32_t>((region.cj_end - region.cj_begin) * grid::kChunkSide) / scale_;
        for (std::int32_t row = top; row < top + height; ++row) std::fill_n(at(left, row), width, kUnknownSalience);
        view.visit(region, 0, [&](grid::ChunkKey key, const auto& chunk) {
            merge(key, reduce(cells_of_chunk(chunk), std::min(scale_, grid::kChunkSide)));
        });
        for (std::int32_t row = top; row < top + height; ++row) {
            auto* const pixels = at(left, row);
            std::transform(pixels, pixels + width, pixels, [&](Salience salience) { return style_.code[salience]; });
        }
    }

    void merge(grid::ChunkKey key, const ReducedChunk& reduced) {
        const std::int32_t left = (key.ci * grid::kChunkSide - cells_.i_begin) / scale_;
        const std::int32_t bottom = (cells_.j_end - 1 - key.cj * grid::kChunkSide) / scale_;
        for (std::int32_t row = 0; row < reduced.side; ++row) {
            auto* pixel = at(left, bottom - row);
            for (std::int32_t column = 0; column < reduced.side; ++column, ++pixel) {
                *pixel = std::max(*pixel, reduced.at(column, row)); // below zoom 3 chunks share a pixel
            }
        }
    }

    [[nodiscard]] std::uint8_t* at(std::int32_t column, std::int32_t row) {
        return &codes_[static_cast<std::size_t>(row * kTileSide + column)];
    }

    Bytes codes_;
    grid::CellBox cells_;
    std::int32_t scale_; // cells along a pixel's side
    const LayerStyle& style_;
};

} // namespace

SharedBytes untouched_codes(mapping::Layer layer) { return untouched(layer).codes; }

SharedBytes tile_codes(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key) {
    if (tile_revision(snapshot, layer, key) == 0) return untouched(layer).codes;
    Canvas canvas(Bytes(kTilePixels), key, style_of(layer));
    mapping::with_layer(snapshot, layer,
                        [&](const auto& view, auto&& cells_of_chunk) { canvas.draw(view, cells_of_chunk); });
    return std::make_shared<const Bytes>(canvas.take());
}

SharedBytes tile_codes(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key, const DrawnTile& earlier) {
    if (tile_revision(snapshot, layer, key) == earlier.revision) return earlier.codes;
    Canvas canvas(*earlier.codes, key, style_of(layer));
    mapping::with_layer(snapshot, layer, [&](const auto& view, auto&& cells_of_chunk) {
        canvas.draw_changes(view, cells_of_chunk, earlier.revision);
    });
    return std::make_shared<const Bytes>(canvas.take());
}

SharedBytes tile_png(const SharedBytes& codes, mapping::Layer layer) {
    return codes == untouched(layer).codes ? untouched(layer).png : png_of(*codes, layer);
}

SharedBytes tile_png(const mapping::Snapshot& snapshot, mapping::Layer layer, TileKey key) {
    return tile_png(tile_codes(snapshot, layer, key), layer);
}

} // namespace scanloom::tiles
