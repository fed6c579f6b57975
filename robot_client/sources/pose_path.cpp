#include "robot_client/sources/pose_path.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::robot {

Pose2 interpolate(const StampedPose& from, const StampedPose& to, double stamp) {
    const double gap = to.stamp - from.stamp;
    const double share = gap > 0.0 ? (stamp - from.stamp) / gap : 0.0;
    return {from.robot.x + share * (to.robot.x - from.robot.x), from.robot.y + share * (to.robot.y - from.robot.y),
            normalize_angle(from.robot.yaw + share * normalize_angle(to.robot.yaw - from.robot.yaw))};
}

PosePath::PosePath(std::vector<StampedPose> samples) : samples_(std::move(samples)) {
    std::stable_sort(samples_.begin(), samples_.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
}

std::optional<Pose2> PosePath::at(double stamp) const {
    const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp,
                                        [](const StampedPose& sample, double time) { return sample.stamp < time; });
    const auto is_near = [&](auto sample) { return std::abs(sample->stamp - stamp) <= kPoseGapMax; };
    const bool has_after = after != samples_.end() && is_near(after);
    const bool has_before = after != samples_.begin() && is_near(after - 1);
    if (!has_after && !has_before) return std::nullopt;
    const StampedPose& from = has_before ? *(after - 1) : *after;
    const StampedPose& to = has_after ? *after : *(after - 1);
    return interpolate(from, to, stamp);
}

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
