#include "server/guide/visit.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::guide {
namespace {

bool is_within(const Pose2& pose, const Point2& place, double radius) {
    return std::hypot(pose.x - place.x, pose.y - place.y) <= radius;
}

bool heads(const Pose2& pose, const Point2& from, const Point2& to) {
    const double direction = std::atan2(to.y - from.y, to.x - from.x);
    return std::abs(normalize_angle(pose.yaw - direction)) <= kLookingWithin;
}

bool faces_target(const Visit& visit, const Pose2& pose, double cell_size_m) {
    return is_within(pose, visit.target, kOnTargetCells * cell_size_m) || heads(pose, visit.goal, visit.target) ||
           heads(pose, {pose.x, pose.y}, visit.target);
}

/// Returns whether the robot stood at the goal for kLookingTakes, going back through its scans as long as they were
/// taken there.
bool has_stood(const Visit& visit, const mapping::RobotState& robot) {
    if (!visit.asking_since) return false;
    for (std::size_t n = robot.trajectory.size(); n > robot.trajectory.begin(); --n) {
        const auto& point = robot.trajectory[n - 1];
        if (point.stamp < *visit.asking_since || !is_within(point.pose, visit.goal, visit.arrival_radius)) return false;
        if (robot.stamp - point.stamp >= kLookingTakes) return true;
    }
    return false;
}

} // namespace

double arrival_radius(double body_radius_m, double cell_size_m) {
    return std::max(body_radius_m, kArrivedCells * cell_size_m);
}

bool is_there(const Visit& visit, const mapping::RobotState& robot) {
    return robot.pose && is_within(*robot.pose, visit.goal, visit.arrival_radius);
}

bool has_looked(const Visit& visit, const mapping::RobotState& robot, double cell_size_m) {
    if (!is_there(visit, robot) || robot.scan_count <= visit.scans_before) return false;
    return faces_target(visit, *robot.pose, cell_size_m) || has_stood(visit, robot);
}

} // namespace scanloom::guide
