#pragma once

#include "robot_client/ros/recording_options.hpp"

#include <string>

namespace CLI {
class App;
}

namespace scanloom::robot {

/// Adds the options for messages of ROS, which set `options`; poses and the largest range are not among them.
/// @param group  heading in the help text
void add_ros_options(CLI::App& app, RecordingOptions& options, const std::string& group);

} // namespace scanloom::robot
