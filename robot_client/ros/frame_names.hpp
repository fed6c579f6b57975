#pragma once

#include <string_view>

/// What the customary names of frames say (REP 105).
namespace scanloom::robot {

/// Returns the name of a frame without the names of robots before it.
[[nodiscard]] inline std::string_view last_name(std::string_view frame) {
    const auto slash = frame.rfind('/');
    return slash == std::string_view::npos ? frame : frame.substr(slash + 1);
}

/// Returns whether a frame is that of a map.
[[nodiscard]] inline bool is_map_name(std::string_view frame) {
    const auto name = last_name(frame);
    return name == "map" || name == "world" || name == "earth";
}

/// Returns whether a frame is that of odometry.
[[nodiscard]] inline bool is_odometry_name(std::string_view frame) {
    return last_name(frame).find("odom") != std::string_view::npos;
}

/// Returns whether a frame does not move with the robot.
[[nodiscard]] inline bool is_fixed_name(std::string_view frame) {
    return is_map_name(frame) || is_odometry_name(frame);
}

} // namespace scanloom::robot
