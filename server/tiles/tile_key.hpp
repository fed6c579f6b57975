#pragma once

#include "common/error/error.hpp"
#include "core/grid/cell.hpp"

#include <cstdint>
#include <string_view>

namespace scanloom::tiles {

inline constexpr std::uint32_t kZoomNative = 9; ///< the finest zoom: one pixel is one cell
inline constexpr std::int32_t kTileSide = 256;  ///< pixels
inline constexpr std::int32_t kTiledCellsHalf = kTileSide << (kZoomNative - 1);

/// The cells that tiles can show: the square at zoom 0, centred on the world origin. Cells outside it are mapped and
/// appear in map images, but not in tiles.
inline constexpr grid::CellBox kTiledCells{-kTiledCellsHalf, -kTiledCellsHalf, kTiledCellsHalf, kTiledCellsHalf};

/// A tile of the XYZ pyramid. Tile (0, 0) is the top-left one; x increases to the right and y DOWN, while the world's y
/// increases upwards.
///
/// Zoom z has 2^z by 2^z tiles. Zoom 0 is one tile of all kTiledCells. A pixel of zoom z is 2^(9 - z) cells wide.
/// At zoom 9, pixel (px, py) is cell (256 x + px - 65536, 65535 - (256 y + py)).
struct TileKey {
    std::uint32_t zoom = 0;
    std::uint32_t x = 0;
    std::uint32_t y = 0;

    friend bool operator==(const TileKey&, const TileKey&) = default;
};

/// Returns the number of cells along each side of a pixel.
/// Precondition: zoom <= kZoomNative.
[[nodiscard]] constexpr std::int32_t cells_per_pixel(std::uint32_t zoom) noexcept {
    return std::int32_t{1} << (kZoomNative - zoom);
}

/// Returns the cells that a tile shows.
/// Precondition: the tile exists.
[[nodiscard]] constexpr grid::CellBox cells_of(TileKey key) noexcept {
    const std::int32_t side = kTileSide * cells_per_pixel(key.zoom);
    const std::int32_t left = -kTiledCellsHalf + static_cast<std::int32_t>(key.x) * side;
    const std::int32_t top = kTiledCellsHalf - static_cast<std::int32_t>(key.y) * side;
    return {left, top - side, left + side, top};
}

/// Returns the tile of a zoom that shows a cell.
/// Precondition: the cell is in kTiledCells.
[[nodiscard]] constexpr TileKey tile_of(grid::Cell cell, std::uint32_t zoom) noexcept {
    const std::int32_t side = kTileSide * cells_per_pixel(zoom);
    return {zoom, static_cast<std::uint32_t>((cell.i + kTiledCellsHalf) / side),
            static_cast<std::uint32_t>((kTiledCellsHalf - 1 - cell.j) / side)};
}

/// Parses a tile's address in a URL. Each number has exactly one spelling: digits, no sign, no leading zeros.
/// Errors: kInvalidField if a text is not a whole number in this spelling; kNotFound if there is no tile for the
///         numbers, which may also be negative or have any number of digits.
[[nodiscard]] Result<TileKey> parse_tile_key(std::string_view zoom, std::string_view x, std::string_view y);

} // namespace scanloom::tiles
