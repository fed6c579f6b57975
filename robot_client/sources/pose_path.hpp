#pragma once

#include "common/geometry/pose2.hpp"

#include <cstddef>
#include <deque>
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

/// Poses that arrive over time. Unlike PosePath it interpolates only between its poses, however far apart they are: the
/// sender of poses also defines the trajectory between them.
class PoseTimeline {
public:
    /// Adds a pose. Poses may arrive in any order.
    void insert(const StampedPose& pose);

    /// Removes the oldest poses beyond `count`.
    void keep_newest(std::size_t count);

    /// Removes the poses later than `stamp`.
    void forget_after(double stamp);

    [[nodiscard]] std::optional<Pose2> at(double stamp) const;

    [[nodiscard]] bool empty() const noexcept { return poses_.empty(); }
    [[nodiscard]] std::size_t size() const noexcept { return poses_.size(); }
    [[nodiscard]] auto begin() const noexcept { return poses_.begin(); }
    [[nodiscard]] auto end() const noexcept { return poses_.end(); }
    /// Pre: not empty.
    [[nodiscard]] const StampedPose& oldest() const noexcept { return poses_.front(); }
    [[nodiscard]] const StampedPose& newest() const noexcept { return poses_.back(); }

private:
    std::deque<StampedPose> poses_; // by increasing stamp
};

} // namespace scanloom::robot
