#include "core/localization/session_poses.hpp"

#include <utility>

namespace scanloom::localization {

void SessionPoses::estimate(ScanTaken& taken, const Sensor& sensor, Revision revision) {
    if (robots_.size() <= taken.robot) robots_.resize(taken.robot + 1);
    auto& robot = robots_[taken.robot];
    if (!robot) robot = std::make_unique<RobotPoses>();
    taken.scan.pose = robot->add(taken.scan, sensor);
    ++scan_count_;
    if (robot->correct_if_due()) corrected_ = revision;
}

mapping::ScanPoses SessionPoses::in_maps() const {
    std::vector<mapping::EstimatedPosesView> robots;
    for (const auto& robot : robots_) robots.push_back(robot ? robot->in_maps() : mapping::EstimatedPosesView());
    return mapping::ScanPoses(std::move(robots));
}

std::vector<StampedPose> SessionPoses::trajectory(RobotIndex robot, Estimate estimate) const {
    std::vector<StampedPose> trajectory;
    const auto* poses = find(robot);
    for (std::size_t scan = 0; poses != nullptr && scan < poses->scan_count(); ++scan) {
        if (!poses->is_in_map(scan)) continue;
        trajectory.push_back(
            {poses->stamp(scan), estimate == Estimate::kFirst ? poses->first(scan) : poses->newest(scan)});
    }
    return trajectory;
}

PoseGraphView SessionPoses::graph(RobotIndex robot) const {
    PoseGraphView view;
    const auto* poses = find(robot);
    if (poses == nullptr) return view;
    const auto& graph = poses->estimator().graph();
    for (std::size_t n = 0; n < graph.size(); ++n) {
        view.keyframes.push_back(scan_matching::pose_of(graph.pose(n)));
        view.is_matched.push_back(graph[n].is_matched);
    }
    view.edges.assign(graph.edges().begin(), graph.edges().end());
    return view;
}

} // namespace scanloom::localization
