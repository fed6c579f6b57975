#pragma once

#include "common/error/error.hpp"
#include "common/ros_map/description.hpp"
#include "common/scan/log_entry.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::tiles {

/// Converts the image of a ROS map to patches of a map, from its bottom row up.
/// @param description  the map's YAML file
/// @param image  PGM (see read_ros_pgm()) or PNG of at most kRosImagePixelsMax pixels
/// Errors: kMalformed if the image is damaged or has another format; kTooLarge if it has too many pixels.
[[nodiscard]] Result<std::vector<MapPatch>> read_ros_image(const RosMapDescription& description,
                                                           std::span<const std::uint8_t> image);

} // namespace scanloom::tiles
