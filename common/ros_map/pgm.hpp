#pragma once

#include "common/error/error.hpp"
#include "common/ros_map/description.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace scanloom {

/// The largest image, in pixels: 400 m by 400 m at 5 cm.
inline constexpr std::int64_t kRosImagePixelsMax = 64'000'000;
inline constexpr std::int64_t kRosImageSideMax = 1'000'000; ///< pixels

/// Checks the size of a map image, in pixels.
/// Errors: kMalformed if a side is not positive; kTooLarge if a side or the number of pixels exceeds its limit above.
[[nodiscard]] Result<> check_ros_image_size(std::int64_t width, std::int64_t height);

/// The cells of a map.
struct MapCells {
    std::size_t width = 0;
    std::vector<MapCell> cells; ///< row by row from the bottom, `width` cells per row

    [[nodiscard]] std::size_t height() const noexcept { return width == 0 ? 0 : cells.size() / width; }
};

/// Reads the cells of a map from a PGM image, plain (P2) or binary (P5). Comments are allowed, and any highest grey up
/// to 65535; above 255, a binary image has two bytes per pixel.
/// @param map    how greys encode occupancy
/// @param image  the contents of the image file
/// @return the cells
/// Errors: kMalformed if it is not a PGM or is damaged; kTooLarge as for check_ros_image_size().
/// Source: pgm(5) of Netpbm.
[[nodiscard]] Result<MapCells> read_ros_pgm(const RosMapDescription& map, std::span<const std::uint8_t> image);

/// Writes the header of a binary PGM as map_saver does. The pixels follow it, one byte each, the top row first.
/// @param width       pixels
/// @param height      pixels
/// @param resolution  metres per pixel
/// @return the header
[[nodiscard]] std::string ros_pgm_header(std::size_t width, std::size_t height, double resolution);

} // namespace scanloom
