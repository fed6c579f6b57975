#pragma once

#include "robot_client/source/pose_path.hpp"

#include <cstddef>
#include <deque>
#include <optional>

namespace scanloom::robot {

/// Poses as they become known. Unlike PosePath it answers for times between its poses only, however far apart they are:
/// who tells where a robot was, tells it for the time between, too.
class PoseTimeline {
public:
    /// Poses may come in any order.
    void insert(const StampedPose& pose);

    /// Forgets the oldest beyond `count`.
    void keep_newest(std::size_t count);

    /// Forgets those of later times.
    void forget_after(double stamp);

    [[nodiscard]] std::optional<Pose2> at(double stamp) const;

    [[nodiscard]] bool empty() const noexcept { return poses_.empty(); }
    [[nodiscard]] std::size_t size() const noexcept { return poses_.size(); }
    [[nodiscard]] auto begin() const noexcept { return poses_.begin(); }
    [[nodiscard]] auto end() const noexcept { return poses_.end(); }
    /// Pre  not empty.
    [[nodiscard]] const StampedPose& oldest() const noexcept { return poses_.front(); }
    [[nodiscard]] const StampedPose& newest() const noexcept { return poses_.back(); }

private:
    std::deque<StampedPose> poses_; // by rising stamp
};

} // namespace scanloom::robot
