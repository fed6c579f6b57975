#include "server/tiles/map_image.hpp"

#include "server/tiles/png.hpp"
#include "server/tiles/tile_key.hpp"

#include <fmt/format.h>

#include <algorithm>
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
            return Error{
                Errc::kInvalidField,
                fmt::format("bbox contains {}; at this cell size its edges must be finite metres within +-{:.0f}", edge,
                            kCellIndexMax * cell_size_m)};
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

namespace {

/// Returns the code of a cell in tiles and images.
struct CodeOf {
    const PercentTable& percent = percent_table();

    Code operator()(mapping::LogOdds cell) const noexcept { return percent[static_cast<std::uint16_t>(cell)]; }
    Code operator()(mapping::HimmCount cell) const noexcept { return cell; }
    Code operator()(classify::CellClass cell) const noexcept { return static_cast<Code>(cell); }
};

} // namespace

Result<MapFrame> map_frame(const mapping::Snapshot& snapshot, mapping::Layer layer, const std::optional<Extent>& bbox,
                           std::int64_t bytes_per_pixel) {
    MapFrame frame{mapping::bounds_of(snapshot, layer), snapshot.config.cell_size};
    if (bbox) {
        const auto cells = cells_in(*bbox, frame.cell_size);
        if (!cells) return cells.error();
        frame.cells = *cells;
    }
    return checked_frame(frame, bytes_per_pixel);
}

Result<MapFrame> checked_frame(const MapFrame& frame, std::int64_t bytes_per_pixel) {
    if (frame.cells.empty()) {
        return Error{Errc::kNotFound,
                     "this layer has no map yet: no scan has contributed to it; select another layer with layer="};
    }
    const auto width = frame.cells.width();
    const auto height = frame.cells.height();
    if (width > kMapSideMax || height > kMapSideMax || width * height > kMapPixelsMax / bytes_per_pixel) {
        return Error{Errc::kTooLarge,
                     fmt::format("this map has {} x {} pixels, more than {} or a side of more than {}; request a part "
                                 "with bbox=min_x,min_y,max_x,max_y in metres, such as the session's main_bounds",
                                 width, height, kMapPixelsMax / bytes_per_pixel, kMapSideMax)};
    }
    return frame;
}

MapImage render_map(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame) {
    MapImage image{frame, layer, Bytes(frame.pixels(), style_of(layer).unknown)};
    draw_cells(snapshot, layer, frame, std::span(image.codes), CodeOf{});
    return image;
}

Bytes map_png(const MapImage& image) {
    const auto& style = style_of(image.layer);
    const auto write = style.is_grey ? grey_png : palette_png;
    return write(image.codes, image.frame.width(), image.frame.height(), style);
}

} // namespace scanloom::tiles
