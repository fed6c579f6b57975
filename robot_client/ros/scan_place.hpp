#pragma once

#include "robot_client/ros/laser_choice.hpp"

#include <string>
#include <variant>

namespace scanloom::robot {

/// Where a scan was taken.
struct ScanPlace {
    Pose2 pose; ///< of the robot in the fixed frame; unless poses are kNone
    LaserMount mount;
};

/// Why it is not known where a scan was taken.
struct NoPlace {
    std::string reason;    ///< in few words, which are the same for all such scans
    bool may_come = false; ///< transforms that come later may say it
    bool is_mount = false; ///< the pose is known, but not the mount
};

/// Finds where a scan was taken.
/// @param tree    transforms until now
/// @param frames  that were chosen
/// @param laser   that took the scan
/// @param frame   of the scan
/// @param middle  when its middle was taken
[[nodiscard]] std::variant<ScanPlace, NoPlace> place_of_scan(const FrameTree& tree, const FrameChoice& frames,
                                                             const FoundLaser& laser, const std::string& frame,
                                                             EpochTime middle);

} // namespace scanloom::robot
