#include "core/localization/pose_history.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::localization {
namespace {

using scan_matching::pose_of;
using scan_matching::transform_of;
using slam::Transform2;

/// A robot's poses as they were estimated at a correction.
class EstimateThen {
public:
    EstimateThen(const GraphMoment& graph, const RobotHistory& robot, std::size_t decided)
        : graph_(graph), robot_(robot), decided_(decided) {}

    /// Returns the pose of a scan; nullopt: it was not known.
    [[nodiscard]] std::optional<Pose2> of(const RobotHistory::Scan& scan) const {
        if (!scan.laser_scan) return scan.added;
        const auto& laser = robot_.laser_scans[*scan.laser_scan];
        const bool is_decided = *scan.laser_scan < decided_;
        if (!(is_decided ? laser.is_matched && graph_.is_located[laser.keyframe] : laser.was_located)) {
            return std::nullopt;
        }
        const Pose2 pose =
            is_decided ? pose_of(graph_.keyframes[laser.keyframe] * laser.T_keyframe_robot) : laser.first;
        return scan.T_laser_scan ? pose_of(transform_of(pose) * *scan.T_laser_scan) : pose;
    }

private:
    const GraphMoment& graph_;
    const RobotHistory& robot_;
    std::size_t decided_;
};

} // namespace

double distance_between(const Transform2& a, const Transform2& b) {
    const Transform2 move = inverse(a) * b;
    return distance_of(move) + std::fabs(yaw_of(move));
}

void follow(std::optional<Pose2>& shown, const Pose2& estimate) {
    if (!shown || distance_between(transform_of(*shown), transform_of(estimate)) > kSettled) shown = estimate;
}

mapping::ScanPoses PoseHistory::at(Revision revision) const {
    const auto later = std::ranges::find_if(graph_, [&](const auto& moment) { return moment->revision > revision; });
    return after(static_cast<std::size_t>(later - graph_.begin()));
}

mapping::ScanPoses PoseHistory::before(double stamp, const Exclusions& exclusions) const {
    std::size_t corrections = graph_.size();
    for (RobotIndex index = 0; index < robots_.size(); ++index) {
        const RobotHistory& robot = robots_[index];
        std::size_t count = 0; // of its scans before a later one
        const auto ends = [&](const RobotHistory::Scan& scan) {
            return scan.stamp > stamp && !exclusions.cover(scan.revision, {index, count + 1, scan.stamp, std::nullopt});
        };
        while (count < robot.scans.size() && !ends(robot.scans[count])) ++count;
        const std::size_t unknown = graph_.size() - robot.moments.size(); // corrections before its first scan
        const auto beyond =
            std::ranges::find_if(robot.moments, [&](const auto& moment) { return moment.scans > count; });
        corrections = std::min(corrections, unknown + static_cast<std::size_t>(beyond - robot.moments.begin()));
    }
    return after(corrections);
}

mapping::ScanPoses PoseHistory::after(std::size_t corrections) const {
    std::vector<mapping::EstimatedPosesView> robots;
    for (const RobotHistory& robot : robots_) {
        mapping::EstimatedPoses poses;
        for (const auto& pose : poses_of(robot, corrections)) poses.append(pose);
        robots.push_back(poses.snapshot());
    }
    return mapping::ScanPoses(std::move(robots), corrections == 0 ? 0 : graph_[corrections - 1]->revision);
}

/// Returns the poses of all scans before the next correction.
std::vector<std::optional<Pose2>> PoseHistory::poses_of(const RobotHistory& robot, std::size_t corrections) const {
    const std::size_t unknown = graph_.size() - robot.moments.size();
    std::vector<std::optional<Pose2>> shown;
    const auto add_until = [&](std::size_t count) {
        while (shown.size() < count) shown.push_back(robot.scans[shown.size()].added);
    };
    for (std::size_t n = unknown; n < corrections; ++n) {
        const auto& [scans, decided] = robot.moments[n - unknown];
        add_until(scans);
        const EstimateThen estimate(*graph_[n], robot, decided);
        for (std::size_t scan = 0; scan < shown.size(); ++scan) {
            if (const auto pose = estimate.of(robot.scans[scan])) follow(shown[scan], *pose);
        }
    }
    if (corrections < unknown) return shown;
    add_until(corrections < graph_.size() ? robot.moments[corrections - unknown].scans : robot.scans.size());
    return shown;
}

} // namespace scanloom::localization
