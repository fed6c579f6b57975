#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/extent.hpp"

#include <optional>

namespace scanloom::tiles {

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

} // namespace scanloom::tiles
