#pragma once

#include "common/error/error.hpp"
#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"
#include "robot_client/sim/world.hpp"

#include <string>

namespace scanloom::robot {

/// A ROS map as a world. Occupied cells are solid, whole squares; unknown ones are not, rays pass through them, but
/// a robot is not put there, and the truth of them is unknown.
/// Beyond the map there is nothing. A robot starts where half a metre is free around it, or, in a map too narrow for
/// that, 0.3 m, within the largest part of the map that it could drive through.
/// Errors  kInvalidField: nowhere in the map is there room for a robot.
/// Cost    the cells.
[[nodiscard]] Result<World> world_of_map(std::string name, const RosMapDescription& map, const MapCells& cells);

} // namespace scanloom::robot
