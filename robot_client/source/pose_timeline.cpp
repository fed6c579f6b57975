#include "robot_client/source/pose_timeline.hpp"

#include <algorithm>

namespace scanloom::robot {

void PoseTimeline::insert(const StampedPose& pose) {
    poses_.insert(std::ranges::upper_bound(poses_, pose.stamp, {}, &StampedPose::stamp), pose);
}

void PoseTimeline::keep_newest(std::size_t count) {
    while (poses_.size() > count) poses_.pop_front();
}

void PoseTimeline::forget_after(double stamp) {
    while (!poses_.empty() && poses_.back().stamp > stamp) poses_.pop_back();
}

std::optional<Pose2> PoseTimeline::at(double stamp) const {
    if (empty() || stamp < oldest().stamp || stamp > newest().stamp) return std::nullopt;
    const auto to = std::ranges::lower_bound(poses_, stamp, {}, &StampedPose::stamp);
    return to == poses_.begin() ? to->robot : interpolate(*(to - 1), *to, stamp);
}

} // namespace scanloom::robot
