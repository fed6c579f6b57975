#pragma once

#include "robot_client/ros/recording_options.hpp"
#include "robot_client/ros/recording_survey.hpp"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// The frames that poses and mounts are of.
struct FrameChoice {
    Poses poses = Poses::kNone;
    std::string base;                      ///< of the robot
    std::string fixed;                     ///< empty if poses are kNone
    std::optional<std::size_t> odom_topic; ///< whose poses replace transforms
    std::string odom_child;                ///< the frame whose transforms they replace; empty if there is no such topic
    std::set<std::string> unused_tf;       ///< namespaces whose transforms are those of other robots
};

/// The laser whose transforms determine the robot's frame.
struct LeadingLaser {
    std::string topic;
    std::string frame;
};

/// Chooses frames from what a recording has, and from what people say. Poses of a chosen odometry topic replace the
/// transforms of its robot's frame.
/// @param laser  if its transforms do not determine the robot's frame, it is the only one whose parent is a frame of odometry,
///               or else of a map
/// Errors: kNotFound if a frame or topic of the options is not there, or the poses that they ask for are not;
///         kInvalidField if the odometry is not that of the stated frame of the robot.
[[nodiscard]] Result<FrameChoice> choose_frames(RecordingSurvey& found, const RecordingOptions& options,
                                                const LeadingLaser& laser);

/// Returns where poses come from, as a sentence for people.
/// @param base        frame of the robot
/// @param fixed       frame that poses are in
/// @param odom_topic  that poses come from; empty: from transforms
[[nodiscard]] std::string poses_text(Poses poses, std::string_view base, std::string_view fixed,
                                     std::string_view odom_topic);

} // namespace scanloom::robot
