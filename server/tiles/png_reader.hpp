#pragma once

#include "common/error/error.hpp"
#include "server/tiles/bytes.hpp"

#include <cstdint>
#include <span>

namespace scanloom::tiles {

struct GreyImage {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    Bytes pixels; ///< 0 is black, row by row from the top
};

/// Decodes a map's PNG of any kind. Colours become grey by their luminance, 16 bits become 8, opacity is ignored. An
/// image that is too large is refused before anything takes memory.
/// Errors: kMalformed: it is not a PNG, or is damaged; kTooLarge: see check_ros_image_size().
/// Source: ISO/IEC 15948:2004 (PNG), decoded by libspng; ITU-R BT.601 (luminance), by OpenCV's cvtColor.
[[nodiscard]] Result<GreyImage> read_png(std::span<const std::uint8_t> png);

} // namespace scanloom::tiles
