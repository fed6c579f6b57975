#include "core/localization/session_poses.hpp"

#include <utility>

namespace scanloom::localization {

void SessionPoses::estimate(ScanTaken& taken, const Sensor& sensor, Revision revision) {
    taken.scan.pose = poses_of(taken.robot).add(taken.scan, sensor, revision);
    ++scan_count_;
    bool is_due = false;
    for (const auto& each : robots_) is_due = (each && each->note_moves()) || is_due; // each follows every scan
    if (is_due && !map_->is_frozen()) correct(revision);
}

void SessionPoses::leave_out(ScanTaken& taken, Revision revision) {
    taken.scan.pose.reset();
    poses_of(taken.robot).leave_out(taken.scan.stamp, revision);
}

void SessionPoses::add_given(const ScanTaken& taken, const Sensor& sensor) {
    const bool is_useful = scan_count_ > 0 && map_->is_frame_given() && !map_->is_frozen();
    if (!is_useful || sensor.kind != SensorKind::kLaser) return;
    const auto pose = scan_matching::transform_of(*taken.scan.pose);
    const auto newest = given_.find(taken.robot);
    const bool is_due = newest == given_.end() ||
                        slam::is_beyond(inverse(newest->second) * pose, slam::kKeyframeDistance, slam::kKeyframeTurn);
    if (!is_due) return;
    auto points = scan_matching::points_of(taken.scan, sensor);
    if (points.points.empty()) return;
    given_[taken.robot] = pose;
    map_->add_given(taken.robot, std::move(points), pose);
}

void SessionPoses::correct(Revision revision) {
    corrected_ = revision;
    for (const auto& each : robots_) {
        if (each) each->correct();
    }
    const auto& graph = map_->graph();
    GraphMoment moment{revision, {graph.poses().begin(), graph.poses().end()}, {}};
    for (std::size_t n = 0; n < graph.size(); ++n) moment.is_located.push_back(graph.fragment_of(n).is_located);
    corrections_.push_back(std::make_shared<const GraphMoment>(std::move(moment)));
}

PoseHistory SessionPoses::history() const {
    std::vector<RobotHistory> robots;
    for (const auto& robot : robots_) robots.push_back(robot ? robot->history() : RobotHistory());
    return {corrections_, std::move(robots)};
}

void SessionPoses::change_mode(bool is_localize_only, Revision revision) {
    if (is_localize_only == map_->is_frozen()) return;
    for (const auto& each : robots_) {
        if (each) each->finish();
    }
    map_->freeze(is_localize_only);
    if (is_localize_only && scan_count_ > 0) correct(revision);
}

void SessionPoses::relocalize(const RobotRelocalized& relocalized) {
    poses_of(relocalized.robot).relocalize({relocalized.near, relocalized.radius});
}

RobotPoses& SessionPoses::poses_of(RobotIndex robot) {
    if (robots_.size() <= robot) robots_.resize(robot + 1);
    if (!robots_[robot]) robots_[robot] = std::make_unique<RobotPoses>(*map_, robot);
    return *robots_[robot];
}

mapping::ScanPoses SessionPoses::in_maps() const {
    std::vector<mapping::EstimatedPosesView> robots;
    for (const auto& robot : robots_) robots.push_back(robot ? robot->in_maps() : mapping::EstimatedPosesView());
    return mapping::ScanPoses(std::move(robots));
}

std::vector<StampedPose> SessionPoses::trajectory(RobotIndex robot, Estimate estimate,
                                                  const Exclusions& exclusions) const {
    std::vector<StampedPose> trajectory;
    const auto* poses = find(robot);
    for (std::size_t scan = 0; poses != nullptr && scan < poses->scan_count(); ++scan) {
        if (!poses->is_fragment_located(scan) || (estimate == Estimate::kFirst && !poses->was_in_map(scan))) continue;
        if (exclusions.cover(poses->revision(scan), {robot, scan + 1, poses->stamp(scan), std::nullopt})) continue;
        trajectory.push_back(
            {poses->stamp(scan), estimate == Estimate::kFirst ? poses->first(scan) : poses->newest(scan)});
    }
    return trajectory;
}

PoseGraphView SessionPoses::graph() const {
    PoseGraphView view;
    const auto& graph = map_->graph();
    for (std::size_t n = 0; n < graph.size(); ++n) {
        const auto& fragment = graph.fragment_of(n);
        view.keyframes.push_back(
            {static_cast<RobotIndex>(fragment.robot), scan_matching::pose_of(graph.pose(n)), fragment.is_located});
    }
    view.edges.assign(graph.edges().begin(), graph.edges().end());
    return view;
}

} // namespace scanloom::localization
