#include "core/slam/trajectory_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace scanloom::slam {
namespace {

constexpr double kKeyframeDistance = 0.8;   // metres from the newest keyframe to the next one
constexpr double kKeyframeTurn = 0.4;       // radians, likewise
constexpr std::size_t kLocalKeyframes = 35; // newest ones that scans are matched to
constexpr double kMotionMax = 10.0;         // metres between two scans; odometry that moves by more has started again
constexpr std::size_t kLost =
    20; // scans in a row without a match, after which a new keyframe starts at the predicted pose

bool is_keyframe_due(const Transform2& T_keyframe_robot) {
    return T_keyframe_robot.x * T_keyframe_robot.x + T_keyframe_robot.y * T_keyframe_robot.y >
               kKeyframeDistance * kKeyframeDistance ||
           std::fabs(yaw_of(T_keyframe_robot)) > kKeyframeTurn;
}

} // namespace

void TrajectoryEstimator::add(ScanPoints scan, const std::optional<Pose2>& odometry) {
    std::optional<Transform2> motion;
    const std::optional<Transform2> now =
        odometry ? std::optional(scan_matching::transform_of(*odometry)) : std::nullopt;
    if (odometry_ && now) motion = inverse(*odometry_) * *now;
    if (motion && !(distance_of(*motion) <= kMotionMax)) motion.reset(); // also if it is NaN
    odometry_ = now;
    if (graph_.size() == 0) {
        first_poses_.emplace_back();
        add_keyframe(std::move(scan), {}, true);
        placed_.push_back({0, {}});
        return;
    }
    const std::size_t newest = graph_.size() - 1;
    const auto decided = tracker_.add(scan, motion, is_keyframe_due);
    first_poses_.push_back(graph_.pose(newest) * tracker_.pose());
    if (decided.empty()) return;
    place(decided);
    const TrackedScan& last = decided.back();
    const bool is_lost = tracker_.unmatched() >= kLost && !scan.points.empty();
    if ((!last.is_matched || !is_keyframe_due(last.T_keyframe_robot)) && !is_lost) return;
    add_keyframe(std::move(scan), last.T_keyframe_robot, !is_lost);
    placed_.back() = {graph_.size() - 1, {}};
}

void TrajectoryEstimator::finish() {
    place(tracker_.decide());
    constexpr int kIterations = 5;
    graph_.optimize(kIterations);
}

void TrajectoryEstimator::place(const std::vector<TrackedScan>& scans) {
    for (const TrackedScan& scan : scans) {
        placed_.push_back({graph_.size() - 1, scan.T_keyframe_robot});
        if (!scan.is_matched) ++unmatched_count_;
    }
}

void TrajectoryEstimator::add_keyframe(ScanPoints scan, const Transform2& T_newest_keyframe, bool is_matched) {
    graph_.add(std::make_shared<const ScanPoints>(std::move(scan)), T_newest_keyframe, is_matched);
    loops_.search(graph_);
    const std::size_t newest = graph_.size() - 1;
    const std::size_t first = newest + 1 - std::min(newest + 1, kLocalKeyframes);
    tracker_.begin(KeyframeMap(graph_.views_around(first, newest, newest)));
}

Pose2 TrajectoryEstimator::pose_of(std::size_t scan) const {
    if (scan >= placed_.size()) return first_pose_of(scan);
    const PlacedScan& placed = placed_[scan];
    return scan_matching::pose_of(graph_.pose(placed.keyframe) * placed.T_keyframe_robot);
}

} // namespace scanloom::slam
