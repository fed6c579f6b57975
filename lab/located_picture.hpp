#pragma once

#include "robot_client/sim/mapped_world.hpp"
#include "server/tiles/bytes.hpp"

namespace scanloom::lab {

/// Draws a map and a view localized in it as a PNG: the map's points in blue, the places of its captures as blue discs,
/// and over them in orange the view at its localized pose, with its sensor as a black cross.
/// Errors: throws std::runtime_error if OpenCV fails.
[[nodiscard]] tiles::Bytes located_png(const robot::MappedWorld& scene, const Pose2& T_map_found);

} // namespace scanloom::lab
