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

    /// The lower-left corner of the lower-left pixel, metres.
    [[nodiscard]] Point2 origin() const noexcept { return {cells.i_begin * cell_size, cells.j_begin * cell_size}; }
};

/// A map or a part of it, at any distance from the origin.
struct MapImage {
    MapFrame frame;
    Bytes percent; ///< width * height, top row first: occupation 0..100, 255 unknown
};

/// The frame of what was asked for: all cells that any scan changed, or the cells a bbox overlaps, whether seen or not.
/// A bbox is not clipped to what was seen: its image and its description, fetched one after the other while the map
/// grows, have to fit each other.
/// Errors  kNotFound: no bbox, and nothing was seen yet; kTooLarge: more pixels than the limits;
///         kInvalidField: a bad bbox.
[[nodiscard]] Result<MapFrame> map_frame(const mapping::Snapshot& snapshot, const std::optional<Extent>& bbox);

/// Cost: the pixels.
[[nodiscard]] MapImage render_map(const mapping::Snapshot& snapshot, const MapFrame& frame);

/// An 8-bit grey PNG in the greys of the tiles.
[[nodiscard]] Bytes map_png(const MapImage& image);

} // namespace scanloom::tiles
