#pragma once

#include "common/error/error.hpp"
#include "common/ros_map/description.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace scanloom {

/// 400 m by 400 m at 5 cm.
inline constexpr std::int64_t kRosImagePixelsMax = 64'000'000;
inline constexpr std::int64_t kRosImageSideMax = 1'000'000;

/// Errors  kMalformed: a side that is none; kTooLarge: one beyond the limits above, or more pixels.
[[nodiscard]] Result<> check_ros_image_size(std::int64_t width, std::int64_t height);

/// The cells of a map.
struct MapCells {
    std::size_t width = 0;
    std::vector<MapCell> cells; ///< row by row from the bottom, `width` of them each

    [[nodiscard]] std::size_t height() const noexcept { return width == 0 ? 0 : cells.size() / width; }
};

/// Reads a PGM, plain (P2) or binary (P5), with comments, of any highest grey up to 65535: above 255, two bytes a
/// pixel.
/// Errors  kMalformed: no such image, or a damaged one; kTooLarge.
/// Source  pgm(5) of Netpbm.
[[nodiscard]] Result<MapCells> read_ros_pgm(const RosMapDescription& map, std::span<const std::uint8_t> image);

/// What stands before the pixels of a binary PGM of bytes, top row first, as map_saver writes it.
[[nodiscard]] std::string ros_pgm_header(std::size_t width, std::size_t height, double resolution);

} // namespace scanloom
