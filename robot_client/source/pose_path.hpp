#pragma once

#include "common/geometry/pose2.hpp"

#include <optional>
#include <vector>

namespace scanloom::robot {

/// Where a recording says the robot was.
struct StampedPose {
    Pose2 robot;
    double stamp = 0.0; ///< seconds, finite
};

/// Between two poses, or beyond them, as if the robot moved evenly and turned the short way.
/// @return `from` where both have the same stamp.
[[nodiscard]] Pose2 interpolate(const StampedPose& from, const StampedPose& to, double stamp);

/// A scan this far in time from the nearest recorded pose has none.
inline constexpr double kPoseGapMax = 1.0; // seconds

/// The poses of a recording whose scans carry none.
class PosePath {
public:
    PosePath() = default;
    explicit PosePath(std::vector<StampedPose> samples);

    /// Interpolated between the samples around `stamp`; nothing where none is within kPoseGapMax.
    [[nodiscard]] std::optional<Pose2> at(double stamp) const;

private:
    std::vector<StampedPose> samples_; // by rising stamp
};

} // namespace scanloom::robot
