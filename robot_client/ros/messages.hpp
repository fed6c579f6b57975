#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "robot_client/recordings/recording.hpp"

#include <Eigen/Geometry>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The messages of ROS 1 and 2 that contain scans and poses.
namespace scanloom::robot {

inline constexpr std::string_view kLaserScanType = "sensor_msgs/LaserScan";
inline constexpr std::string_view kMultiEchoType = "sensor_msgs/MultiEchoLaserScan";
inline constexpr std::string_view kOdometryType = "nav_msgs/Odometry";
inline constexpr std::string_view kTransformsType = "tf2_msgs/TFMessage";
inline constexpr std::string_view kOldTransformsType = "tf/tfMessage";

/// A time in nanoseconds since the epoch of the recording's clock, which simulations begin at 0.
using RosTime = std::int64_t;

/// std_msgs/Header. Frames are stored without the leading "/" of early ROS 1.
struct RosHeader {
    RosTime stamp = 0;
    std::string frame;
};

/// sensor_msgs/LaserScan without its intensities, which no layer uses. The stamp is that of the first beam. Metres,
/// radians, seconds.
struct RosLaserScan {
    RosHeader header;
    float angle_min = 0.0F;
    float angle_max = 0.0F;
    float angle_increment = 0.0F;
    float time_increment = 0.0F; ///< from one beam to the next
    float scan_time = 0.0F;      ///< from one scan to the next
    float range_min = 0.0F;
    float range_max = 0.0F;
    std::vector<float> ranges;
};

/// geometry_msgs/TransformStamped.
struct RosTransform {
    RosHeader header; ///< frame: the parent
    std::string child;
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity(); ///< the rotation is normalised
};

/// Decodes a scan. Of a sensor_msgs/MultiEchoLaserScan, each beam has its first echo; a beam without one has no return.
/// @param type  kLaserScanType or kMultiEchoType
/// Errors: kMalformed if the bytes are no such message.
[[nodiscard]] Result<RosLaserScan> decode_laser_scan(std::string_view bytes, MessageEncoding encoding,
                                                     std::string_view type = kLaserScanType);

/// Decodes the pose of a nav_msgs/Odometry.
/// Errors: kMalformed if the bytes are no such message; kInvalidField if the pose is not finite or has no rotation.
[[nodiscard]] Result<RosTransform> decode_odometry(std::string_view bytes, MessageEncoding encoding);

/// Decodes the transforms of a tf2_msgs/TFMessage or tf/tfMessage. Transforms that are not finite, have no rotation or
/// no child are left out.
/// @param left_out  increased by their number
/// Errors: kMalformed if the bytes are no such message.
[[nodiscard]] Result<std::vector<RosTransform>> decode_transforms(std::string_view bytes, MessageEncoding encoding,
                                                                  std::size_t& left_out);

} // namespace scanloom::robot
