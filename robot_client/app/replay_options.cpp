#include "robot_client/app/replay_options.hpp"

#include "common/app/command_line.hpp"
#include "robot_client/app/ros_options.hpp"

#include <CLI/CLI.hpp>

namespace scanloom::robot {

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
    auto* replay =
        app.add_subcommand("replay", "Replay a CARMEN log, a ROS 1 bag, an MCAP file or a recording of rosbag2");
    // not required() in the parser: an environment for both sources would then require it everywhere
    replay
        ->add_option(
            "FILE", options.file,
            "CARMEN log (plain, gzip or bzip2), ROS 1 bag, MCAP file, or a database or the directory of rosbag2; the "
            "content decides which it is, not the name")
        ->configurable(false);
    add_checked(*replay, "--speed", options.speed,
                "1 = as recorded, 0 = as fast as the server accepts scans. A pause of more than 10 minutes in the "
                "log counts as 10",
                check_not_negative);
    add_ros_options(*replay, options.recording, kRecordingsGroup);
    return replay;
}

CLI::App* add_info(CLI::App& app, InfoOptions& options) {
    auto* info = app.add_subcommand(
        "info", "List the topics, frames and times of a recording of ROS, and the command that replays it");
    info->add_option("FILE", options.file, "ROS 1 bag, MCAP file, rosbag2 database or directory")->configurable(false);
    add_ros_options(*info, options.recording, kRecordingsGroup);
    return info;
}

} // namespace scanloom::robot
