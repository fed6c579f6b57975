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

/// Returns the options of a group that were stated, as a command line has them: " --topic '/scan'".
[[nodiscard]] std::string stated_arguments(const CLI::App& app, const std::string& group);

/// Returns a text in the quotes of a shell.
[[nodiscard]] std::string quoted(const std::string& text);

} // namespace scanloom::robot
