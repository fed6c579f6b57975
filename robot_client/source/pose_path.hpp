#pragma once

#include "common/geometry/pose2.hpp"

#include <optional>
#include <vector>

namespace scanloom::robot {

/// The robot's pose at one time, as recorded.
struct StampedPose {
    Pose2 robot;
    double stamp = 0.0; ///< seconds, finite
};

/// Interpolates between two poses, or extrapolates, with constant velocity and the shorter direction of turning.
/// @return `from` if both have the same stamp
[[nodiscard]] Pose2 interpolate(const StampedPose& from, const StampedPose& to, double stamp);

/// A scan that is farther than this in time from the nearest recorded pose has no pose.
inline constexpr double kPoseGapMax = 1.0; // seconds

/// The poses of a recording whose scans contain none.
class PosePath {
public:
    PosePath() = default;
    explicit PosePath(std::vector<StampedPose> samples);

    /// Interpolates between the samples around `stamp`; returns nullopt if none is within kPoseGapMax.
    [[nodiscard]] std::optional<Pose2> at(double stamp) const;

private:
    std::vector<StampedPose> samples_; // by increasing stamp
};

} // namespace scanloom::robot
