#pragma once

#include "common/error/error.hpp"
#include "common/scan/sensor.hpp"
#include "core/scan_matching/transform2.hpp"

#include <optional>

namespace scanloom::localization {

/// Checks that the scans of a sensor can be used to estimate poses.
/// @param sensor  a laser, or a sonar, which is not used for it
/// Errors: kInvalidField: a laser is more than scan_matching::kMountDistanceMax from its robot's origin.
[[nodiscard]] Result<> check_mount(const Sensor& sensor);

/// Detects a wrong yaw of a laser's mount from the directions of motion in odometry and scans. Straight motions of the
/// last metres are compared.
/// Threads: one at a time.
class MountCheck {
public:
    /// Adds the motion between two scans that fit the map.
    /// @param by_odometry  T_before_after of the robot, by its odometry
    /// @param by_scans     the same, by the scans
    void add(const scan_matching::Transform2& by_odometry, const scan_matching::Transform2& by_scans);

    /// Returns by how much the mount's yaw is too large, radians in (-pi, pi]; nullopt: it seems to be right, or the
    /// robot has not moved enough.
    [[nodiscard]] std::optional<double> yaw_error() const;

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.along_, self.across_, self.travelled_, self.distance_);
    }

private:
    double along_ = 0.0;     // square metres: sum of the scalar products of both motions
    double across_ = 0.0;    // square metres: sum of their cross products
    double travelled_ = 0.0; // square metres: sum of the squares of the odometry's motions
    double distance_ = 0.0;  // metres, of the motions in the sums
};

} // namespace scanloom::localization
