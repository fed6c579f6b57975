#pragma once

#include "common/error/error.hpp"
#include "common/ros_map/description.hpp"
#include "common/scan/map_patch.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::tiles {

/// Reads the image of a ROS map, PGM (see read_ros_pgm()) or PNG of at most kRosImagePixelsMax pixels, into patches of
/// a map, from its bottom row on.
/// Errors  kMalformed: no such image, or a damaged one; kTooLarge.
[[nodiscard]] Result<std::vector<MapPatch>> read_ros_image(const RosMapDescription& description,
                                                           std::span<const std::uint8_t> image);

} // namespace scanloom::tiles
