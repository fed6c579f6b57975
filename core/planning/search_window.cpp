#include "core/planning/search_window.hpp"

#include "core/grid/chunk_areas.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace scanloom::planning {
namespace {

using classify::ClassChunk;
using classify::ClassView;
using grid::CellBox;
using grid::ChunkKey;

constexpr std::int64_t kChunkCells = std::int64_t{grid::kChunkSide} * grid::kChunkSide;

std::vector<ChunkKey> explored_chunks(const ClassView& classes) {
    std::vector<ChunkKey> chunks;
    classes.visit(grid::kNumberedChunks, 0, [&](ChunkKey key, const ClassChunk&) { chunks.push_back(key); });
    return chunks;
}

} // namespace

Result<grid::Cell> numbered_cell(const Point2& point, double cell_size_m) {
    const double cells_per_metre = 1.0 / cell_size_m;
    const double i = std::floor(point.x * cells_per_metre);
    const double j = std::floor(point.y * cells_per_metre);
    const auto end = static_cast<double>(grid::kNumberedChunks.ci_end * grid::kChunkSide);
    if (!(std::abs(i) < end && std::abs(j) < end)) { // also true for NaN
        return Error{Errc::kInvalidField, fmt::format("the point ({}, {}) has no cell in any map", point.x, point.y)};
    }
    return grid::Cell{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)};
}

Result<SearchWindow> search_window(const ClassView& classes, double cell_size_m, const Reach& reach,
                                   std::span<const Point2> ends) {
    std::vector<ChunkKey> chunks_of_ends;
    for (const Point2& end : ends) {
        const auto cell = numbered_cell(end, cell_size_m);
        if (!cell) return cell.error();
        chunks_of_ends.push_back(grid::chunk_of(*cell));
    }
    // Cells of two chunks with n chunks between them are more than n chunk sides apart.
    grid::ChunkAreas areas(explored_chunks(classes),
                           1 + static_cast<std::int32_t>((reach.body_radius_m / cell_size_m + 2.0) / grid::kChunkSide));
    CellBox window;
    if (ends.empty()) {
        areas.take_all(window);
        if (reach.allow_unknown && !window.empty()) window = grid::grown(window, 1);
    } else if (!reach.allow_unknown) {
        areas.take_around(chunks_of_ends.front(), window);
    } else {
        for (const ChunkKey key : chunks_of_ends) {
            window.include(grid::box_of(key));
            areas.take_around(key, window);
        }
        areas.take_touched(window);
    }
    if (window.empty()) return SearchWindow{{0, 0, 0, 0}, 0};
    if (window.width() > kWindowCellsMax / window.height()) {
        return Error{
            Errc::kTooLarge,
            fmt::format("planning needs a window of {} x {} cells, more than {}: plan on a map of larger cells",
                        window.width(), window.height(), kWindowCellsMax)};
    }
    const std::int64_t cells =
        reach.allow_unknown ? window.width() * window.height() : areas.taken_count() * kChunkCells;
    if (cells <= kSearchCellsMax) return SearchWindow{window, cells};
    return Error{Errc::kTooLarge,
                 fmt::format("planning needs a search of {} {}cells, more than {}: plan on a map of larger cells",
                             cells, reach.allow_unknown ? "" : "explored ", kSearchCellsMax)};
}

} // namespace scanloom::planning
