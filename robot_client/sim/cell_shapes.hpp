#pragma once

#include "common/ros_map/pgm.hpp"
#include "robot_client/sim/shapes.hpp"

#include <vector>

namespace scanloom::robot {

/// Position of a map's cells.
struct MapFrame {
    double resolution = 0.05; ///< metres per cell
    double origin_x = 0.0;    ///< metres; lower-left corner of cell (0, 0)
    double origin_y = 0.0;

    [[nodiscard]] double x(std::size_t column) const noexcept {
        return origin_x + static_cast<double>(column) * resolution;
    }
    [[nodiscard]] double y(std::size_t row) const noexcept { return origin_y + static_cast<double>(row) * resolution; }
};

/// Returns the cells of one kind as few boxes that do not overlap: runs of a row, merged with equal runs above.
[[nodiscard]] std::vector<Box> boxes_of(const MapCells& map, MapCell kind, const MapFrame& frame);

/// Returns the border of the occupied cells as maximal straight segments, with the occupied side on their left.
[[nodiscard]] std::vector<Segment> outlines_of(const MapCells& map, const MapFrame& frame);

} // namespace scanloom::robot
