#pragma once

#include "server/tiles/map_image.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace scanloom::tiles {

/// Returns a map as CSV: one line per row of cells, top row first. The values are the codes of the layer, with -1 in
/// place of 255 for unknown cells, as in nav_msgs/OccupancyGrid.
[[nodiscard]] std::string map_csv(const MapImage& image);

/// Returns the bytes per cell in map_npy().
[[nodiscard]] std::int64_t npy_bytes_per_cell(mapping::Layer layer) noexcept;

/// Returns a map as a NumPy file: an array of shape (height, width), top row first.
///   occupancy, sonar  float32, the probability of occupation; NaN unknown
///   himm              uint8, the counter; 255 unseen
///   classification    uint8, the classes
/// Source: NumPy Enhancement Proposal 1, format version 1.0.
[[nodiscard]] Bytes map_npy(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame);

/// A map as the pair of files that ROS map_saver writes and that map_server (ROS 1) and nav2_map_server load. The image
/// has three greys: 254 free, 0 occupied, 205 neither.
/// Source: the greys of map_saver of ROS 1 and nav2.

/// Encodes a map as a binary PGM (P5), top row first. Cells in danger are free.
/// @param config  thresholds of free and occupied: class_p_free and class_p_occupied (for occupancy and sonar, in whole
///                percent), class_himm_free and class_himm_occupied
[[nodiscard]] Bytes map_pgm(const MapImage& image, const mapping::MapConfig& config);

/// Returns the cells of nav_msgs/OccupancyGrid, bottom row first: 0 free, 100 occupied, -1 neither, as map_pgm()
/// decides. Localization of ROS (amcl) takes no other values.
/// @param config  as for map_pgm()
[[nodiscard]] std::vector<std::int8_t> occupancy_grid(const MapImage& image, const mapping::MapConfig& config);

/// Returns the description that belongs to the image. It expects the image as `map.pgm` in the same directory.
[[nodiscard]] std::string map_yaml(const MapFrame& frame);

/// Returns the world file of a map's image, top row first: the size of a pixel, and the centre of the upper left one,
/// metres in the map frame. Programs for maps, such as QGIS, place map.png by map.pgw in the same directory.
/// Source: Esri, World files for raster datasets.
[[nodiscard]] std::string world_file(const MapFrame& frame);

} // namespace scanloom::tiles
