#include "server/tiles/map_image.hpp"

#include "server/tiles/draw_cells.hpp"
#include "server/tiles/png.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::tiles {
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
        return Error{Errc::kNotFound, "there is no map yet in this layer: no scan that it is made of has seen anything "
                                      "by then; layer= names others"};
    }
    const auto width = frame.cells.width();
    const auto height = frame.cells.height();
    if (width > kMapSideMax || height > kMapSideMax || width * height > kMapPixelsMax / bytes_per_pixel) {
        return Error{Errc::kTooLarge,
                     fmt::format("this map has {} x {} pixels, more than {} or a side of more than {}; ask for a part "
                                 "of it with bbox=min_x,min_y,max_x,max_y in metres, such as the session's main_bounds",
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
