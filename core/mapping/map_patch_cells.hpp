#pragma once

#include "common/scan/log_entry.hpp"
#include "core/grid/cell.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace scanloom::mapping {

/// Returns the box of cells that a patch covers.
/// @param patch      metres, map frame
/// @param cell_size  metres; of the returned cells, not of the patch
[[nodiscard]] inline grid::CellBox cells_of(const MapPatch& patch, double cell_size) noexcept {
    if (patch.cells.empty()) return {};
    const double per_metre = 1.0 / cell_size;
    const auto floor_cell = [&](double metres) { return static_cast<std::int32_t>(std::floor(metres * per_metre)); };
    const double max_x = patch.min_x + static_cast<double>(patch.width) * patch.cell_size;
    const double max_y = patch.min_y + static_cast<double>(patch.height()) * patch.cell_size;
    return {floor_cell(patch.min_x), floor_cell(patch.min_y), floor_cell(max_x) + 1, floor_cell(max_y) + 1};
}

/// Calls visit(Cell, MapCell) for the cells of a map that a patch covers, including cells that the patch does not know.
///
/// If the patch's cells are no larger than the map's, there is one call for each patch cell, with the map cell that
/// contains its centre. Otherwise, there is one call for each map cell whose centre lies in the patch.
/// @param patch      metres, map frame
/// @param cell_size  metres; of the map's cells
/// @param visit      called in the order of the patch's or the map's rows, from the bottom
template <class Visit>
void for_each_cell_of(const MapPatch& patch, double cell_size, Visit&& visit) {
    constexpr double kSnap = 1e-9; // treats sizes that differ by rounding alone as equal
    const double per_metre = 1.0 / cell_size;
    const auto ours = [&](double metres) { return static_cast<std::int32_t>(std::floor(metres * per_metre)); };
    if (patch.cell_size <= cell_size * (1.0 + kSnap)) {
        for (std::size_t n = 0; n < patch.cells.size(); ++n) {
            const double x = patch.min_x + (static_cast<double>(n % patch.width) + 0.5) * patch.cell_size;
            const auto row = n / patch.width;
            const double y = patch.min_y + (static_cast<double>(row) + 0.5) * patch.cell_size;
            visit(grid::Cell{ours(x), ours(y)}, patch.cells[n]);
        }
        return;
    }
    const grid::CellBox box = cells_of(patch, cell_size);
    for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
        const double row = std::floor(((j + 0.5) * cell_size - patch.min_y) / patch.cell_size);
        if (row < 0.0 || row >= static_cast<double>(patch.height())) continue;
        for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
            const double column = std::floor(((i + 0.5) * cell_size - patch.min_x) / patch.cell_size);
            if (column < 0.0 || column >= static_cast<double>(patch.width)) continue;
            visit(grid::Cell{i, j},
                  patch.cells[static_cast<std::size_t>(row) * patch.width + static_cast<std::size_t>(column)]);
        }
    }
}

} // namespace scanloom::mapping
