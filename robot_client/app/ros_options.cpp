#include "robot_client/app/ros_options.hpp"

#include "robot_client/app/pose_text.hpp"

#include <CLI/CLI.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <fmt/format.h>

#include <optional>
#include <tuple>
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

} // namespace

std::string quoted(const std::string& text) {
    return fmt::format("'{}'", boost::algorithm::replace_all_copy(text, "'", R"('\'')"));
}

std::string stated_arguments(const CLI::App& app, const std::string& group) {
    std::string arguments;
    for (const auto* option : app.get_options()) {
        if (option->get_group() != group) continue;
        for (const auto& value : option->results()) {
            arguments += fmt::format(" {} {}", option->get_name(), quoted(value));
        }
    }
    return arguments;
}

void add_ros_options(CLI::App& app, RecordingOptions& options, const std::string& group) {
    const auto grouped = [&](CLI::Option* option) { option->group(group); };
    grouped(app.add_option("--topic", options.topics,
                           "Topic of a laser; may be repeated. Default: all lasers whose mounts are known, or else "
                           "the topic with most scans")
                ->allow_extra_args(false));
    grouped(app.add_option("--odom-topic", options.odom_topic,
                           "Topic of nav_msgs/Odometry, used instead of the transforms of the robot's frame. "
                           "Default: transforms, or the only odometry if they contain no poses"));
    grouped(app.add_option("--base-frame", options.base_frame,
                           "Frame of the robot. Default: the one below the odometry's or the map's"));
    grouped(app.add_option("--fixed-frame", options.fixed_frame,
                           "Frame that poses are in. Default: map with --poses map, else the odometry's"));
    grouped(app.add_option_function<std::vector<std::string>>(
                   "--mount",
                   [&options](const std::vector<std::string>& texts) {
                       for (const auto& text : texts) options.mounts.push_back(parse_mount(text).value());
                   },
                   "X,Y,YAW of the laser on the robot in metres and radians, or TOPIC=X,Y,YAW of one of several; "
                   "replaces the mount of the transforms")
                ->check(check_mount)
                ->allow_extra_args(false));
    for (auto [name, meaning, help] :
         {std::tuple("--zero", &options.ranges.is_zero_no_return,
                     "Meaning of readings of 0: broken, or no-return. Default: broken"),
          std::tuple("--beyond-max", &options.ranges.is_beyond_no_return,
                     "Meaning of finite readings above the range_max of their message. Default: no-return if they all "
                     "are one number and none is infinite, else broken")}) {
        add_meaning(app, name, *meaning, help);
        grouped(app.get_option(name));
    }
}

} // namespace scanloom::robot
