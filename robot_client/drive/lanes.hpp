#pragma once

#include "robot_client/drive/ground.hpp"

#include <vector>

namespace scanloom::robot {

/// A straight piece of a sweep, along x; metres in the map frame.
struct Lane {
    Point2 west{0.0, 0.0};
    Point2 east{0.0, 0.0};
};

/// Lanes one above the other, from the south, that are swept to and fro without a choice.
using Block = std::vector<Lane>;

/// Parts cells into blocks and each block into lanes at most `spacing_m` apart, evenly: one along its lowest row and
/// one along its highest, but none where all of that row borders another block, whose lane there is near enough.
/// A block ends where a row has several neighbours above or below it, or shares one.
/// @param cells  of the ground's plan, 0 or 1
/// Source  Choset, Pignon, Coverage Path Planning: The Boustrophedon Cellular Decomposition (FSR 1997).
[[nodiscard]] std::vector<Block> lanes_over(const Ground& ground, const std::vector<std::uint8_t>& cells,
                                            double spacing_m);

} // namespace scanloom::robot
