#pragma once

#include "server/mapping/snapshot.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/extent.hpp"

#include <optional>

namespace scanloom::tiles {

/// 400 m by 400 m at 5 cm; a byte each, and some copies on the way to a file.
inline constexpr std::int64_t kMapPixelsMax = 64'000'000;
inline constexpr std::int64_t kMapSideMax = 1'000'000; ///< pixels; what libpng writes

/// Which cells a map image shows, one for each pixel.
struct MapFrame {
    grid::CellBox cells;
    double cell_size = 0.05; ///< metres

    [[nodiscard]] std::int32_t width() const noexcept { return static_cast<std::int32_t>(cells.width()); }
    [[nodiscard]] std::int32_t height() const noexcept { return static_cast<std::int32_t>(cells.height()); }
    [[nodiscard]] std::size_t pixels_wide() const noexcept { return static_cast<std::size_t>(cells.width()); }
    [[nodiscard]] std::size_t pixels() const noexcept {
        return static_cast<std::size_t>(cells.width() * cells.height());
    }

    /// The lower-left corner of the lower-left pixel, metres.
    [[nodiscard]] Point2 origin() const noexcept { return {cells.i_begin * cell_size, cells.j_begin * cell_size}; }
};

/// A layer of a map or of a part of it, at any distance from the origin.
struct MapImage {
    MapFrame frame;
    mapping::Layer layer = mapping::Layer::kOccupancy;
    Bytes codes; ///< width * height (see Code), top row first
};

/// The frame of what was asked for: all cells in which the layer shows anything, or the cells a bbox overlaps, whether
/// seen or not. A bbox is not clipped to what was seen: its image and its description, fetched one after the other
/// while the map grows, have to fit each other.
/// @param bytes_per_pixel  of the file to be made: what takes more may have fewer pixels
/// Errors  kNotFound: no bbox, and nothing was seen yet; kTooLarge: more pixels than the limits;
///         kInvalidField: a bad bbox.
[[nodiscard]] Result<MapFrame> map_frame(const mapping::Snapshot& snapshot, mapping::Layer layer,
                                         const std::optional<Extent>& bbox, std::int64_t bytes_per_pixel = 1);

/// The frame, if it can be made an image of.
/// Errors  kNotFound: it is empty; kTooLarge: see map_frame().
[[nodiscard]] Result<MapFrame> checked_frame(const MapFrame& frame, std::int64_t bytes_per_pixel = 1);

/// Cost: the pixels.
[[nodiscard]] MapImage render_map(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame);

/// A PNG in the colours of the tiles: 8-bit grey where all of them are, else with a palette.
[[nodiscard]] Bytes map_png(const MapImage& image);

} // namespace scanloom::tiles
