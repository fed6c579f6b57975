#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/ros/messages.hpp"
#include "robot_client/sources/source.hpp"

#include <Eigen/Geometry>

#include <cstdint>
#include <optional>

/// LaserScan messages as scans.
namespace scanloom::robot {

/// Readings without a return are believed up to this range at most unless an option states another one: drivers often
/// state more than their laser sees.
inline constexpr double kBelievedRangeMax = 50.0; // metres

/// What people say about readings; where they say nothing, RangeHabits decides.
struct RangeOptions {
    std::optional<double> range_max;   ///< metres
    std::optional<NoReturn> no_return; ///< of +inf and what else is no return; default: free
    std::optional<bool> is_zero_no_return;
    std::optional<bool> is_beyond_no_return; ///< finite readings above the message's range_max
};

/// What the readings of a topic mean.
struct RangeMeaning {
    std::optional<double> range_max; ///< metres; nullopt: that of each message, at most kBelievedRangeMax
    RangeMm no_return = kNoReturn;   ///< kNoReturn or kInvalidRange
    bool is_zero_no_return = false;
    bool is_beyond_no_return = false;
};

/// Finds what a driver means by readings that are no lengths. REP 117 says: +inf is no return, everything else that is
/// not between range_min and range_max is broken. Drivers that never send +inf may have an older habit: one number
/// above range_max (such as 81.91) stands for no return. A reading of 0 is broken: drivers also send it for what is too
/// near.
class RangeHabits {
public:
    /// Adds the readings of a scan.
    void add(const RosLaserScan& scan);

    /// Returns what readings of the topic mean.
    [[nodiscard]] RangeMeaning meaning(const RangeOptions& options) const;

private:
    bool has_infinite_ = false;
    std::optional<float> beyond_; // a reading above range_max
    bool is_beyond_constant_ = true;
};

/// How a laser is mounted.
struct LaserMount {
    Pose2 T_robot_laser;
    bool is_upside_down = false; ///< then the angles of beams are negated

    friend bool operator==(const LaserMount&, const LaserMount&) = default;
};

/// Returns the mount in the plane.
/// @param T_robot_laser  as in /tf
/// Errors: kInvalidField if the laser is tilted by more than 15 degrees, or is farther away than a sensor may be.
[[nodiscard]] Result<LaserMount> mount_of(const Eigen::Isometry3d& T_robot_laser);

/// Returns the pose in the plane: the direction of the x axis is the yaw.
[[nodiscard]] Pose2 planar(const Eigen::Isometry3d& T_a_b);

/// Returns the seconds from the first beam to the last; 0 if the message does not state it, or states what cannot be.
[[nodiscard]] double duration_of(const RosLaserScan& scan);

/// Returns when the middle of the scan was taken. If the message has no stamp, this is when it was recorded.
[[nodiscard]] RosTime middle_of(const RosLaserScan& scan, RosTime recorded);

/// Returns whether a scan can be used.
/// Errors: kInvalidField with what is wrong in few words, which are the same for all such scans.
[[nodiscard]] Result<> check_usable(const RosLaserScan& scan);

/// Returns the sensor of a scan, without id and name.
/// Precondition: the scan is usable.
[[nodiscard]] Sensor sensor_of(const RosLaserScan& scan, const RangeMeaning& meaning, const LaserMount& mount);

/// Returns a scan without sensor, pose and seq. Its stamp is that of its middle.
/// Precondition: the scan is usable.
[[nodiscard]] Scan scan_of(const RosLaserScan& message, RosTime recorded, const RangeMeaning& meaning);

} // namespace scanloom::robot
