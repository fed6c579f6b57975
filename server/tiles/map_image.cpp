#include "server/tiles/map_image.hpp"

#include "server/tiles/grey_png.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::tiles {
namespace {

/// Copies the cells that a chunk and the frame share.
void draw(MapImage& image, grid::ChunkKey at, const mapping::OccupancyChunk& chunk) {
    const auto& cells = image.frame.cells;
    const auto& percent = percent_table();
    const std::int32_t i_begin = std::max(cells.i_begin, at.ci * grid::kChunkSide);
    const std::int32_t i_end = std::min(cells.i_end, (at.ci + 1) * grid::kChunkSide);
    const std::int32_t j_begin = std::max(cells.j_begin, at.cj * grid::kChunkSide);
    const std::int32_t j_end = std::min(cells.j_end, (at.cj + 1) * grid::kChunkSide);
    for (std::int32_t j = j_begin; j < j_end; ++j) {
        const auto row = static_cast<std::size_t>(cells.j_end - 1 - j);
        auto* pixel = &image.percent[row * static_cast<std::size_t>(image.frame.width()) +
                                     static_cast<std::size_t>(i_begin - cells.i_begin)];
        const auto* cell = &chunk.at({i_begin, j});
        std::transform(cell, cell + (i_end - i_begin), pixel,
                       [&](mapping::LogOdds l) { return percent[static_cast<std::uint16_t>(l)]; });
    }
}

} // namespace

Result<MapFrame> map_frame(const mapping::Snapshot& snapshot, const std::optional<Extent>& bbox) {
    MapFrame frame{snapshot.bounds, snapshot.config.cell_size};
    if (bbox) {
        const auto cells = cells_in(*bbox, frame.cell_size);
        if (!cells) return cells.error();
        frame.cells = *cells;
    }
    if (frame.cells.empty()) {
        return Error{Errc::kNotFound, "the session has no map yet: no scan has seen anything; ask again after one has"};
    }
    const auto width = frame.cells.width();
    const auto height = frame.cells.height();
    if (width > kMapSideMax || height > kMapSideMax || width * height > kMapPixelsMax) {
        return Error{Errc::kTooLarge,
                     fmt::format("this map has {} x {} pixels, more than {} or a side of more than {}; ask for a part "
                                 "of it with bbox=min_x,min_y,max_x,max_y in metres",
                                 width, height, kMapPixelsMax, kMapSideMax)};
    }
    return frame;
}

MapImage render_map(const mapping::Snapshot& snapshot, const MapFrame& frame) {
    const auto pixels = static_cast<std::size_t>(frame.cells.width() * frame.cells.height());
    MapImage image{frame, Bytes(pixels, kUnknownPercent)};
    snapshot.occupancy.visit(grid::chunks_of(frame.cells), 0,
                             [&](grid::ChunkKey at, const mapping::OccupancyChunk& chunk) { draw(image, at, chunk); });
    return image;
}

Bytes map_png(const MapImage& image) { return grey_png(image.percent, image.frame.width(), image.frame.height()); }

} // namespace scanloom::tiles
