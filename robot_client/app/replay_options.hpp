#pragma once

#include "robot_client/ros/recording_plan.hpp"

#include <string>

namespace CLI {
class App;
}

namespace scanloom::robot {

/// A log of CARMEN or a recording of ROS.
struct ReplayOptions {
    std::string file;
    double speed = 0.0;         ///< 0 = as fast as the server accepts scans, 1 = as recorded
    RecordingOptions recording; ///< of a recording of ROS; poses and ranges are not set here
};

/// Lists what a recording contains; needs no server.
struct InfoOptions {
    std::string file;
};

/// Adds the subcommand, which sets `options`.
CLI::App* add_replay(CLI::App& app, ReplayOptions& options);

/// Adds the subcommand, which sets `options`.
CLI::App* add_info(CLI::App& app, InfoOptions& options);

} // namespace scanloom::robot
