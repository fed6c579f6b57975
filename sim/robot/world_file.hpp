#pragma once

#include "common/error/error.hpp"
#include "sim/world.hpp"

#include <string>
#include <string_view>

namespace scanloom::sim {

/// Returns whether `world` names a file: *.yaml or *.yml.
[[nodiscard]] bool is_world_file(std::string_view world);

/// Checks the name of a built-in world; does not read files. For CLI::Option::check().
/// @return what is wrong; empty if nothing is
[[nodiscard]] std::string check_world(const std::string& world);

/// Loads a built-in world by name (see find_world()), or a ROS map by the path of its YAML file, which names a PGM
/// image in the same folder.
/// Errors: those of find_world(). For a map, with the path of the file first: kNotFound if it cannot be read; those of
///         parse_ros_yaml(), read_ros_pgm() and world_of_map().
[[nodiscard]] Result<World> load_world(const std::string& world);

} // namespace scanloom::sim
