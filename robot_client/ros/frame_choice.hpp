#pragma once

#include "robot_client/ros/recording_options.hpp"
#include "robot_client/ros/recording_survey.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// The frames that poses and mounts are of.
struct FrameChoice {
    Poses poses = Poses::kNone;
    std::string base;                      ///< of the robot
    std::string fixed;                     ///< empty if poses are kNone
    std::optional<std::size_t> odom_topic; ///< whose poses replace the transforms of the robot's frame
};

/// Chooses frames from what a recording has, and from what people say. Poses of a chosen odometry topic replace the
/// transforms of its robot's frame.
/// @param laser_frame  of the laser whose transforms tell the robot's frame. If they do not, it is the only one whose
///                     parent is a frame of odometry, or else of a map
/// Errors: kNotFound if a frame or topic of the options is not there, or the poses that they ask for are not.
[[nodiscard]] Result<FrameChoice> choose_frames(RecordingSurvey& found, const RecordingOptions& options,
                                                const std::string& laser_frame);

/// Returns where poses come from, as a sentence for people.
/// @param base        frame of the robot
/// @param fixed       frame that poses are in
/// @param odom_topic  that poses come from; empty: from transforms
[[nodiscard]] std::string poses_text(Poses poses, std::string_view base, std::string_view fixed,
                                     std::string_view odom_topic);

} // namespace scanloom::robot
