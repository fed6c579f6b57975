#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "server/foxglove/schemas.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

/// A robot's scans and poses as messages of ROS 2, serialised. Frames: "map"; "ROBOT/base_link" is the robot frame;
/// "ROBOT/sensor_ID" is the frame of one of its sensors. Metres and radians.
namespace scanloom::foxglove {

inline constexpr std::string_view kMapFrame = "map";

/// Returns the name of the robot frame.
[[nodiscard]] std::string robot_frame(std::string_view robot);

/// Returns the name of the frame of a robot's scans whose place in the map is not known: no transform leads to it.
[[nodiscard]] std::string unplaced_frame(std::string_view robot);

/// Returns the name of a sensor's frame.
[[nodiscard]] std::string sensor_frame(std::string_view robot, const Sensor& sensor);

/// A robot and when it was where.
struct RobotAt {
    std::string_view robot; ///< its name
    double stamp = 0.0;     ///< seconds
    Pose2 T_map_robot;
};

/// A robot, where it was, and its sensors.
struct PlacedRobot {
    RobotAt at;
    std::vector<const Sensor*> sensors; ///< not null
};

/// Returns the transforms from the map to each robot, and from the robot to each of its sensors: Message::kTransforms.
[[nodiscard]] std::string transforms_message(std::span<const PlacedRobot> robots);

/// Returns the robot's pose in the map: Message::kPose.
[[nodiscard]] std::string pose_message(const RobotAt& at);

/// Returns a way in the map: Message::kPath.
/// @param poses  T_map_robot along the way
/// @param stamp  seconds
[[nodiscard]] std::string path_message(std::span<const Pose2> poses, double stamp);

/// Returns the stamp of a scan's first beam, which sensor_msgs/LaserScan has; a Scan has that of the middle.
/// @return seconds
[[nodiscard]] inline double first_beam_stamp(const Scan& scan) noexcept { return scan.stamp - scan.duration / 2.0; }

/// Returns a scan: Message::kScan. A beam without a return has an infinite range, and an invalid reading is NaN (REP
/// 117). The message has evenly spaced beams. If those of the scan are not, it has twice as many, up to 4096: each
/// reading is at the nearest one, and the others are NaN.
/// @param frame   in which the sensor is at the origin
/// @param scan    that the sensor took
/// @param sensor  as described when it took the scan
[[nodiscard]] std::string scan_message(std::string_view frame, const Scan& scan, const Sensor& sensor);

} // namespace scanloom::foxglove
