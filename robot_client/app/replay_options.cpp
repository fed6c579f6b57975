#include "robot_client/app/replay_options.hpp"

#include "common/app/command_line.hpp"
#include "robot_client/app/pose_text.hpp"

#include <CLI/CLI.hpp>

#include <optional>
#include <utility>
#include <vector>

namespace scanloom::robot {
namespace {

/// Parses X,Y,YAW or TOPIC=X,Y,YAW.
Result<StatedMount> parse_mount(const std::string& text) {
    const auto equals = text.rfind('=');
    const auto mount = parse_pose(equals == std::string::npos ? text : text.substr(equals + 1));
    if (!mount) return mount.error();
    return StatedMount{equals == std::string::npos ? std::string() : text.substr(0, equals), *mount};
}

std::string check_mount(const std::string& text) {
    const auto mount = parse_mount(text);
    return mount ? std::string() : mount.error().message;
}

/// Adds an option with the words "broken" and "no-return".
void add_meaning(CLI::App& app, const std::string& name, std::optional<bool>& is_no_return, const std::string& help) {
    app.add_option_function<std::string>(
           name, [&is_no_return](const std::string& word) { is_no_return = word == "no-return"; }, help)
        ->check(CLI::IsMember({"broken", "no-return"}));
}

void add_recording_options(CLI::App& replay, RecordingOptions& options) {
    const std::string group = "Recordings of ROS";
    const auto grouped = [&](CLI::Option* option) { option->group(group); };
    grouped(replay.add_option("--topic", options.topics,
                              "Topic of a laser; may be repeated. Default: all lasers whose mounts are known, or else "
                              "the topic with most scans"));
    grouped(replay.add_option("--odom-topic", options.odom_topic,
                              "Topic of nav_msgs/Odometry, used instead of the transforms of the robot's frame. "
                              "Default: transforms, or the only odometry if they contain no poses"));
    grouped(replay.add_option("--base-frame", options.base_frame,
                              "Frame of the robot. Default: the one below the odometry's or the map's"));
    grouped(replay.add_option("--fixed-frame", options.fixed_frame,
                              "Frame that poses are in. Default: map with --poses map, else the odometry's"));
    grouped(replay
                .add_option_function<std::vector<std::string>>(
                    "--mount",
                    [&options](const std::vector<std::string>& texts) {
                        for (const auto& text : texts) options.mounts.push_back(parse_mount(text).value());
                    },
                    "X,Y,YAW of the laser on the robot in metres and radians, or TOPIC=X,Y,YAW of one of several; "
                    "replaces the mount of the transforms")
                ->check(check_mount));
    for (auto [name, meaning, help] :
         {std::tuple("--zero", &options.ranges.is_zero_no_return,
                     "Meaning of readings of 0: broken, or no-return. Default: broken"),
          std::tuple("--beyond-max", &options.ranges.is_beyond_no_return,
                     "Meaning of finite readings above the range_max of their message. Default: no-return if they all "
                     "are one number and none is infinite, else broken")}) {
        add_meaning(replay, name, *meaning, help);
        grouped(replay.get_option(name));
    }
}

} // namespace

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
    auto* replay = app.add_subcommand("replay", "Replay a CARMEN log, a ROS 1 bag, an MCAP file or a rosbag2 database");
    // not required() in the parser: an environment for both sources would then require it everywhere
    replay
        ->add_option(
            "FILE", options.file,
            "CARMEN log (plain, gzip or bzip2), ROS 1 bag, MCAP file or rosbag2 database; the content decides which it "
            "is, not the name")
        ->configurable(false);
    add_checked(*replay, "--speed", options.speed,
                "1 = as recorded, 0 = as fast as the server accepts scans. A pause of more than 10 minutes in the "
                "log counts as 10",
                check_not_negative);
    add_recording_options(*replay, options.recording);
    return replay;
}

CLI::App* add_info(CLI::App& app, InfoOptions& options) {
    auto* info = app.add_subcommand(
        "info", "List the topics, frames and times of a recording of ROS, and the command that replays it");
    info->add_option("FILE", options.file, "ROS 1 bag, MCAP or rosbag2 .db3")->configurable(false);
    return info;
}

} // namespace scanloom::robot
