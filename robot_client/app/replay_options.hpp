#pragma once

#include "robot_client/ros/recording_plan.hpp"

#include <string>

namespace CLI {
class App;
}

namespace scanloom::robot {

/// Heading of the options for recordings of ROS in the help text.
inline constexpr const char* kRecordingsGroup = "Recordings of ROS";

/// A log of CARMEN or a recording of ROS.
struct ReplayOptions {
    std::string file;
    double speed = 0.0;         ///< 0 = as fast as the server accepts scans, 1 = as recorded
    RecordingOptions recording; ///< of a recording of ROS
    std::string ros_arguments;  ///< the options that are only for recordings of ROS, as on the command line
};

/// Lists what a recording contains; needs no server.
struct InfoOptions {
    std::string file;
    RecordingOptions recording;
    std::string scan_arguments; ///< options of all sources, as on the command line
    std::string ros_arguments;  ///< those of recordings of ROS
};

/// Adds the subcommand, which sets `options` but for `ros_arguments`.
CLI::App* add_replay(CLI::App& app, ReplayOptions& options);

/// Adds the subcommand, which sets `options` but for the arguments.
CLI::App* add_info(CLI::App& app, InfoOptions& options);

} // namespace scanloom::robot
