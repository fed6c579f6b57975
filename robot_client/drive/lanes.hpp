#pragma once

#include "robot_client/drive/ground.hpp"

#include <vector>

namespace scanloom::robot {

/// A straight segment of a sweep, parallel to the x axis; metres in the map frame.
struct Lane {
    Point2 west{0.0, 0.0};
    Point2 east{0.0, 0.0};
};

/// Lanes one above the other, from the south, that are swept back and forth without choosing an order.
using Block = std::vector<Lane>;

/// Divides cells into blocks and each block into evenly spaced lanes at most `spacing_m` apart. There is one lane along
/// the lowest row and one along the highest, but none if that whole row borders another block, whose lane there is near
/// enough. A block ends where a row has several neighbours above or below it, or shares one.
/// @param cells  for each cell of the ground's plan, 1 if it belongs to the area, else 0
/// Source: Choset, Pignon, Coverage Path Planning: The Boustrophedon Cellular Decomposition (FSR 1997).
[[nodiscard]] std::vector<Block> lanes_over(const Ground& ground, const std::vector<std::uint8_t>& cells,
                                            double spacing_m);

} // namespace scanloom::robot
