#include "core/slam/trajectory_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace scanloom::slam {
namespace {

constexpr double kKeyframeDistance = 0.8;   // metres from the newest keyframe to the next one
constexpr double kKeyframeTurn = 0.4;       // radians, likewise
constexpr double kNewSightDistance = 0.2;   // metres, likewise, if the scan shows much that the map does not have
constexpr double kNewSightTurn = 0.1;       // radians, likewise
constexpr double kNewSightInliers = 0.6;    // of such a scan's points, those that fit the map, at most
constexpr std::size_t kLocalKeyframes = 35; // newest ones that scans are matched to
constexpr double kMotionMax = 10.0;         // metres between two scans; odometry that moves by more has started again

/// Returns whether a pose is farther from the newest keyframe than this.
bool is_beyond(const Transform2& T_keyframe_robot, double distance, double turn) {
    const Transform2& T = T_keyframe_robot;
    return T.x * T.x + T.y * T.y > distance * distance || std::fabs(yaw_of(T)) > turn;
}

bool is_keyframe_due(const TrackedScan& scan) {
    if (is_beyond(scan.T_keyframe_robot, kKeyframeDistance, kKeyframeTurn)) return true;
    return scan.inlier_ratio <= kNewSightInliers && is_beyond(scan.T_keyframe_robot, kNewSightDistance, kNewSightTurn);
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
        const Transform2 start = now.value_or(Transform2());
        first_.push_back({start, true});
        parts_.push_back({0, true});
        add_keyframe(std::move(scan), start, true);
        placed_.push_back({0, {}});
        newest_ = {{}, 1.0, true};
        return;
    }
    const std::size_t newest = graph_.size() - 1;
    const auto decided = tracker_.add(scan, motion, is_keyframe_due);
    newest_ = decided.empty() ? tracker_.newest() : decided.back();
    first_.push_back({graph_.pose(newest) * newest_.T_keyframe_robot, newest_.is_matched && is_connected(newest)});
    if (decided.empty()) return;
    place(decided);
    const TrackedScan& last = decided.back();
    const bool is_lost = tracker_.unmatched() >= kLost && !scan.points.empty();
    if ((!last.is_matched || !is_keyframe_due(last)) && !is_lost) return;
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
        placed_.push_back({graph_.size() - 1, scan.T_keyframe_robot, scan.is_matched});
        if (!scan.is_matched) ++unmatched_count_;
    }
}

void TrajectoryEstimator::add_keyframe(ScanPoints scan, const Transform2& T_newest_keyframe, bool is_matched) {
    graph_.add(std::make_shared<const ScanPoints>(std::move(scan)), T_newest_keyframe, is_matched);
    const std::size_t newest = graph_.size() - 1;
    if (!is_matched) parts_.push_back({newest, false});
    loops_.search(graph_);
    connect_parts();
    const std::size_t first = newest + 1 - std::min(newest + 1, kLocalKeyframes);
    tracker_.begin(KeyframeMap(graph_.views_around(first, newest, newest)));
}

/// Returns the index of the part of the trajectory that contains a keyframe.
std::size_t TrajectoryEstimator::part_of(std::size_t keyframe) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(parts_, keyframe, {}, &Part::first) - parts_.begin()) - 1;
}

/// Finds the parts to which loop edges lead from connected ones.
void TrajectoryEstimator::connect_parts() {
    if (connected_parts() == parts_.size()) return;
    for (bool is_new = true; is_new;) {
        is_new = false;
        for (const Edge& edge : graph_.edges()) {
            if (!edge.is_robust || edge.weight < kUsedWeight) continue;
            if (is_connected(edge.from) == is_connected(edge.to)) continue;
            parts_[part_of(edge.from)].is_connected = true;
            parts_[part_of(edge.to)].is_connected = true;
            is_new = true;
        }
    }
}

bool TrajectoryEstimator::is_located(std::size_t scan) const {
    if (scan >= placed_.size()) return first_[scan].is_matched;
    return placed_[scan].is_matched && is_connected(placed_[scan].keyframe);
}

Pose2 TrajectoryEstimator::pose_of(std::size_t scan) const {
    if (scan >= placed_.size()) return first_pose_of(scan);
    const PlacedScan& placed = placed_[scan];
    return scan_matching::pose_of(graph_.pose(placed.keyframe) * placed.T_keyframe_robot);
}

} // namespace scanloom::slam
