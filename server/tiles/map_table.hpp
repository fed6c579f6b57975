#pragma once

#include "server/tiles/map_image.hpp"

#include <string>

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

} // namespace scanloom::tiles
