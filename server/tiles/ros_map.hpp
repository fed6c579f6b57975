#pragma once

#include "server/tiles/map_image.hpp"

#include <string>

namespace scanloom::tiles {

/// A map as the file pair of ROS map_saver, which map_server (ROS 1) and nav2_map_server load:
/// three greys, 254 free, 0 occupied, 205 neither.
/// Source  the greys of map_saver of ROS 1 and nav2.

/// Binary PGM (P5), top row first. What is free and what occupied the settings of the classes say: class_p_free and
/// class_p_occupied (of occupancy and sonar, as whole per cent), class_himm_free and class_himm_occupied. Cells in
/// danger are free.
[[nodiscard]] Bytes map_pgm(const MapImage& image, const mapping::MapConfig& config);

/// The description that goes with it; it names the image `map.pgm`, beside itself.
[[nodiscard]] std::string map_yaml(const MapFrame& frame);

} // namespace scanloom::tiles
