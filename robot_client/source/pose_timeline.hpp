#pragma once

#include "robot_client/source/pose_path.hpp"

#include <cstddef>
#include <deque>
#include <optional>

namespace scanloom::robot {

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
