#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/poses.hpp"
#include "robot_client/ros/laser_conversion.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// A mount that a person states.
struct StatedMount {
    std::string topic; ///< empty: of the only laser
    Pose2 T_robot_laser;
};

/// How the messages of a robot are read, recorded or live. What is not stated follows from the messages.
struct RecordingOptions {
    std::optional<Poses> poses;
    std::vector<std::string> topics; ///< of lasers; empty: all
    std::string odom_topic;          ///< nav_msgs/Odometry, used instead of the transforms of its robot
    std::string base_frame;          ///< of the robot
    std::string fixed_frame;         ///< that poses are in
    std::vector<StatedMount> mounts; ///< they replace those of /tf
    RangeOptions ranges;
};

} // namespace scanloom::robot
