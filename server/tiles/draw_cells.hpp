#pragma once

#include "server/mapping/layer_cells.hpp"
#include "server/tiles/map_image.hpp"

#include <algorithm>
#include <span>

namespace scanloom::tiles {

/// Converts each cell of a frame with `convert` and writes the results to the frame's pixels, top row first. Pixels
/// without a chunk remain unchanged.
template <class Pixel, class Convert>
void draw_cells(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame, std::span<Pixel> pixels,
                Convert&& convert) {
    const auto& box = frame.cells;
    const auto width = static_cast<std::size_t>(frame.width());
    mapping::with_layer(snapshot, layer, [&](const auto& view, auto&& cells_of) {
        view.visit(grid::chunks_of(box), 0, [&](grid::ChunkKey at, const auto& chunk) {
            const auto& cells = cells_of(chunk);
            const std::int32_t i_begin = std::max(box.i_begin, at.ci * grid::kChunkSide);
            const std::int32_t i_end = std::min(box.i_end, (at.ci + 1) * grid::kChunkSide);
            const std::int32_t j_begin = std::max(box.j_begin, at.cj * grid::kChunkSide);
            const std::int32_t j_end = std::min(box.j_end, (at.cj + 1) * grid::kChunkSide);
            for (std::int32_t j = j_begin; j < j_end; ++j) {
                const auto row = static_cast<std::size_t>(box.j_end - 1 - j);
                const auto* cell = &cells[grid::index_in_chunk({i_begin, j})];
                std::transform(cell, cell + (i_end - i_begin),
                               &pixels[row * width + static_cast<std::size_t>(i_begin - box.i_begin)], convert);
            }
        });
    });
}

} // namespace scanloom::tiles
