#pragma once

#include "robot_client/source/carmen_line.hpp"

#include <optional>
#include <vector>

namespace scanloom::robot {

/// A RAWLASER line this far in time from the nearest ODOM line has no pose.
inline constexpr double kOdometryGapMax = 1.0; // seconds

/// Where a log's ODOM lines say the robot was.
class CarmenPath {
public:
    CarmenPath() = default;
    explicit CarmenPath(std::vector<CarmenOdometry> samples);

    /// Interpolated between the samples around `stamp`; nothing where none is within kOdometryGapMax.
    [[nodiscard]] std::optional<Pose2> at(double stamp) const;

private:
    std::vector<CarmenOdometry> samples_; // by rising stamp
};

} // namespace scanloom::robot
