#pragma once

#include "common/error/error.hpp"
#include "robot_client/sim/world.hpp"

#include <string>
#include <string_view>

namespace scanloom::robot {

/// Whether a world is meant that is read from a file: *.yaml or *.yml.
[[nodiscard]] bool is_world_file(std::string_view world);

/// A world of a name (see find_world()), or a ROS map: the path of its YAML, which names the image beside it, a PGM.
/// Errors  those of find_world(); of a map, with the path of the file in front: kNotFound: it cannot be read; those of
///         parse_ros_yaml(), read_ros_pgm() and world_of_map().
[[nodiscard]] Result<World> load_world(const std::string& world);

} // namespace scanloom::robot
