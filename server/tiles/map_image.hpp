#pragma once

#include "common/error/error.hpp"
#include "core/grid/cell.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"

#include <algorithm>
#include <optional>
#include <span>

namespace scanloom::tiles {

/// A rectangle in the map frame. Metres.
struct Extent {
    double min_x = 0.0;
    double min_y = 0.0;
    double max_x = 0.0;
    double max_y = 0.0;

    friend bool operator==(const Extent&, const Extent&) = default;
};

/// Returns the rectangle that a box of cells covers.
/// Precondition: the box is not empty.
[[nodiscard]] Extent extent_of(const grid::CellBox& cells, double cell_size_m) noexcept;

/// Returns the rectangle that the tiles of a session cover: the square at zoom 0 of the tile pyramid.
[[nodiscard]] Extent tiled_extent(double cell_size_m) noexcept;

/// Returns the cells that a rectangle overlaps. An edge within a millionth of a cell of a cell border counts as on the
/// border, so that rounding of decimal metres does not add a cell.
/// Errors: kInvalidField if the rectangle is not finite, is empty, or lies outside the range of cell indices.
[[nodiscard]] Result<grid::CellBox> cells_in(const Extent& extent, double cell_size_m);

/// The largest map image, in pixels: 400 m by 400 m at 5 cm. A pixel takes one byte, and making a file takes a few
/// copies.
inline constexpr std::int64_t kMapPixelsMax = 64'000'000;
inline constexpr std::int64_t kMapSideMax = 1'000'000; ///< pixels; limit of libpng

/// The cells that a map image shows, one per pixel.
struct MapFrame {
    grid::CellBox cells;
    double cell_size = 0.05; ///< metres

    [[nodiscard]] std::int32_t width() const noexcept { return static_cast<std::int32_t>(cells.width()); }
    [[nodiscard]] std::int32_t height() const noexcept { return static_cast<std::int32_t>(cells.height()); }
    [[nodiscard]] std::size_t pixels_wide() const noexcept { return static_cast<std::size_t>(cells.width()); }
    [[nodiscard]] std::size_t pixels() const noexcept {
        return static_cast<std::size_t>(cells.width() * cells.height());
    }

    /// Returns the lower-left corner of the lower-left pixel, map frame, metres.
    [[nodiscard]] Point2 origin() const noexcept { return {cells.i_begin * cell_size, cells.j_begin * cell_size}; }
};

/// An image of a layer, of the whole map or of a part at any distance from the origin.
struct MapImage {
    MapFrame frame;
    mapping::Layer layer = mapping::Layer::kOccupancy;
    Bytes codes; ///< width * height (see Code), top row first
};

/// Returns the frame for a request: all cells in which the layer shows anything, or the cells that a bbox overlaps.
///
/// A bbox is not clipped to the observed cells. Its image and its description may be fetched one after the other while
/// the map grows, and must match.
/// @param bbox  map frame, metres
/// @param bytes_per_pixel  of the file to be made; larger pixels reduce the number of pixels allowed
/// Errors: kNotFound if there is no bbox and the layer is empty; kTooLarge if the frame exceeds the pixel limits;
///         kInvalidField if the bbox is invalid.
[[nodiscard]] Result<MapFrame> map_frame(const mapping::Snapshot& snapshot, mapping::Layer layer,
                                         const std::optional<Extent>& bbox, std::int64_t bytes_per_pixel = 1);

/// Returns the frame if an image of it can be made.
/// Errors: kNotFound if the frame is empty; kTooLarge if it exceeds the pixel limits of map_frame().
[[nodiscard]] Result<MapFrame> checked_frame(const MapFrame& frame, std::int64_t bytes_per_pixel = 1);

/// Renders the cells of a frame.
/// Cost: proportional to the number of pixels.
[[nodiscard]] MapImage render_map(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame);

/// Encodes an image as a PNG in the colours of the tiles: 8-bit grey if all colours are grey, otherwise with a palette.
[[nodiscard]] Bytes map_png(const MapImage& image);

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
