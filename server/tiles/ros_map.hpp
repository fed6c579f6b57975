#pragma once

#include "server/tiles/map_image.hpp"

#include <string>

namespace scanloom::tiles {

/// A map as the file pair of ROS map_saver, which map_server (ROS 1) and nav2_map_server load:
/// three greys, 254 free, 0 occupied, 205 neither.
/// Source  formats of map_saver: occupied from 65 %, free up to 25 %, as saved by ROS 1 and nav2.

/// Binary PGM (P5), top row first. HIMM counters are free and occupied by the thresholds of the classes; cells in
/// danger are free.
[[nodiscard]] Bytes map_pgm(const MapImage& image, const mapping::MapConfig& config);

/// The description that goes with it; it names the image `map.pgm`, beside itself.
[[nodiscard]] std::string map_yaml(const MapFrame& frame);

} // namespace scanloom::tiles
