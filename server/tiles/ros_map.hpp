#pragma once

#include "server/tiles/map_image.hpp"

#include <string>

namespace scanloom::tiles {

/// A map as the pair of files that ROS map_saver writes and that map_server (ROS 1) and nav2_map_server load. The image
/// has three greys: 254 free, 0 occupied, 205 neither.
/// Source: the greys of map_saver of ROS 1 and nav2.

/// Encodes a map as a binary PGM (P5), top row first. Cells in danger are free.
/// @param config  thresholds of free and occupied: class_p_free and class_p_occupied (for occupancy and sonar, in whole
///                percent), class_himm_free and class_himm_occupied
[[nodiscard]] Bytes map_pgm(const MapImage& image, const mapping::MapConfig& config);

/// Returns the description that belongs to the image. It expects the image as `map.pgm` in the same directory.
[[nodiscard]] std::string map_yaml(const MapFrame& frame);

} // namespace scanloom::tiles
