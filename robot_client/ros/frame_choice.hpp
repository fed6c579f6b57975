#pragma once

#include "robot_client/ros/recording_plan.hpp"

#include <cstddef>
#include <optional>
#include <string>

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
/// @param laser_frame  of the laser with most scans
/// Errors: kNotFound if a frame or topic of the options is not there, or the poses that they ask for are not.
[[nodiscard]] Result<FrameChoice> choose_frames(RecordingSurvey& found, const RecordingOptions& options,
                                                const std::string& laser_frame);

} // namespace scanloom::robot
