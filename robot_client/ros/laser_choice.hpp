#pragma once

#include "robot_client/ros/frame_choice.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

inline constexpr std::string_view kMountUnknown = "mount unknown"; ///< see FoundLaser::left_out

/// A laser that was found.
struct FoundLaser {
    std::size_t topic = 0;
    std::string_view left_out;  ///< why it is not used: a literal; empty: it is
    std::optional<Pose2> mount; ///< that a person states
    bool is_connected = false;  ///< by transforms, to the robot's frame
    std::uint32_t id = 0;       ///< Sensor::id, if it is used
};

/// The frames and lasers that are used.
struct LaserChoice {
    FrameChoice frames;
    std::vector<FoundLaser> lasers; ///< the one with most scans first
    std::vector<std::string> notes; ///< what people should know: sentences
};

/// Chooses frames, and the lasers whose mounts are known or else the one with most scans.
/// Poses are kMap if /tf has a frame of that name above the robot's, else kOdometry if there is odometry, else kNone.
/// The robot's frame is the one below the odometry's or the map's.
/// Where several namespaces have transforms, as "/robot1/tf" and "/robot2/tf", those around the laser's topic are used.
/// @param found  its trees are used up: poses of a chosen odometry topic replace transforms in them
/// Errors: kNotFound if there is no laser, or what the options name is not there; kInvalidField if they contradict.
[[nodiscard]] Result<LaserChoice> choose_lasers(RecordingSurvey& found, const RecordingOptions& options);

} // namespace scanloom::robot
