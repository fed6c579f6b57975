#pragma once

#include "robot_client/sim/mapped_world.hpp"
#include "server/tiles/bytes.hpp"

namespace scanloom::lab {

/// A map and a view that was found in it, as a PNG: the map's points in blue, the places that it was seen from as blue
/// discs, and over them in orange the view, at the pose where it was found; there its sensor is a black cross.
/// Throws std::runtime_error when OpenCV fails.
[[nodiscard]] tiles::Bytes located_png(const robot::MappedWorld& scene, const Pose2& T_map_found);

} // namespace scanloom::lab
