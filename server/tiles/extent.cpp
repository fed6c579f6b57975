#include "server/tiles/extent.hpp"

#include "server/tiles/tile_key.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::tiles {
namespace {

constexpr double kSnapCells = 1e-6;
constexpr double kCellIndexMax = 1 << 30; // widths and chunk borders still fit in 32 bits

} // namespace

Extent extent_of(const grid::CellBox& cells, double cell_size_m) noexcept {
    return {cells.i_begin * cell_size_m, cells.j_begin * cell_size_m, cells.i_end * cell_size_m,
            cells.j_end * cell_size_m};
}

Extent tiled_extent(double cell_size_m) noexcept { return extent_of(kTiledCells, cell_size_m); }

Result<grid::CellBox> cells_in(const Extent& extent, double cell_size_m) {
    const double cells_per_metre = 1.0 / cell_size_m;
    for (const double edge : {extent.min_x, extent.min_y, extent.max_x, extent.max_y}) {
        if (!(std::abs(edge * cells_per_metre) <= kCellIndexMax)) { // true for NaN too
            return Error{Errc::kInvalidField,
                         fmt::format("bbox holds {}; at this cell size its edges must be finite metres within +-{:.0f}",
                                     edge, kCellIndexMax * cell_size_m)};
        }
    }
    if (extent.min_x >= extent.max_x || extent.min_y >= extent.max_y) {
        return Error{Errc::kInvalidField, "bbox is empty; give min_x,min_y,max_x,max_y in metres with min below max"};
    }
    const auto first = [&](double metres) {
        return static_cast<std::int32_t>(std::floor(metres * cells_per_metre + kSnapCells));
    };
    const auto end = [&](double metres, std::int32_t begin) {
        return std::max(begin + 1, static_cast<std::int32_t>(std::ceil(metres * cells_per_metre - kSnapCells)));
    };
    const std::int32_t i_begin = first(extent.min_x);
    const std::int32_t j_begin = first(extent.min_y);
    return grid::CellBox{i_begin, j_begin, end(extent.max_x, i_begin), end(extent.max_y, j_begin)};
}

} // namespace scanloom::tiles
