#pragma once

#include "sim/shapes.hpp"

#include <vector>

namespace scanloom::robot {

/// Appends the four outer walls of a building that is centred on the origin.
/// @param half_width, half_height  half its inner extent along x and y, metres
inline void add_shell(std::vector<Box>& solids, double half_width, double half_height) {
    constexpr double kThick = 0.3;
    const double outer_x = half_width + kThick;
    const double outer_y = half_height + kThick;
    solids.push_back({-outer_x, -outer_y, outer_x, -half_height});
    solids.push_back({-outer_x, half_height, outer_x, outer_y});
    solids.push_back({-outer_x, -outer_y, -half_width, outer_y});
    solids.push_back({half_width, -outer_y, outer_x, outer_y});
}

} // namespace scanloom::robot
