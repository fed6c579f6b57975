#pragma once

#include "core/classify/cell_class.hpp"
#include "core/slam/shared_map.hpp"

#include <vector>

namespace scanloom::localization {

/// Returns what a laser would see from all over the free space of a map, one view in each square of 2 m. Robots are
/// located in an imported map by them, as in the keyframes of other robots.
/// @param classes    the cells of the map
/// @param cell_size  metres
/// @return the views, neighbours after each other; empty if nothing is free
/// Cost: in proportion to the free area.
[[nodiscard]] std::vector<slam::KnownView> views_of(const classify::ClassView& classes, double cell_size);

} // namespace scanloom::localization
