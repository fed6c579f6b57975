#include "core/localization/robot_poses.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scanloom::localization {
namespace {

using scan_matching::inverse;
using scan_matching::pose_of;
using scan_matching::Transform2;
using scan_matching::transform_of;

constexpr double kImprovement = 0.05;  // metres
constexpr std::size_t kPauseMin = 50;  // keyframes
constexpr std::size_t kPausePart = 10; // of all keyframes: a tenth, if that is more

} // namespace

bool is_worth_a_correction(double move, std::size_t keyframes, std::size_t since_then) noexcept {
    const bool is_paused = since_then < std::max(kPauseMin, keyframes / kPausePart);
    return move > (is_paused ? RobotPoses::kJump : kImprovement);
}

std::optional<Pose2> RobotPoses::add(const Scan& scan, const Sensor& sensor, Revision revision) {
    if (sensor.kind == SensorKind::kLaser) {
        estimator_.add(scan, sensor);
        laser_scans_.push_back(scans_.size());
        scans_.push_back({estimator_.scan_count() - 1, {}, scan.stamp});
        check_mount(scan);
        laser_odometry_ = scan.odometry;
        if (laser_scans_.size() == 1) fragments_ = estimator_.found_fragments();
    } else {
        scans_.push_back(placed(scan));
    }
    ScanAnchor& added = scans_.back();
    location_.T_map_robot = newest(scan_count() - 1);
    if (scan.odometry) {
        location_.T_map_odom = pose_of(transform_of(location_.T_map_robot) * inverse(transform_of(*scan.odometry)));
    }
    // A scan that closes a loop corrects itself, too: maps show the estimate before, like those of the scans around it.
    added.first =
        sensor.kind == SensorKind::kLaser ? estimator_.first_pose_of(added.laser_scan) : location_.T_map_robot;
    const auto in_maps = is_located(scan_count() - 1) ? std::optional(added.first) : std::nullopt;
    in_maps_.append(in_maps);
    added.was_shown = in_maps.has_value();
    added.revision = revision;
    if (added.laser_scan != kNoLaserScan) added.was_in_map = estimator_.is_fragment_located(added.laser_scan);
    return in_maps;
}

void RobotPoses::leave_out(double stamp, Revision revision) {
    scans_.push_back({kExcluded, {}, stamp, {}, false, false, revision});
    in_maps_.append(std::nullopt);
}

std::size_t RobotPoses::estimated_count() const noexcept {
    const auto excluded = std::ranges::count(scans_, kExcluded, &ScanAnchor::laser_scan);
    return scans_.size() - static_cast<std::size_t>(excluded);
}

/// Compares the motion since the laser scan before with the odometry.
void RobotPoses::check_mount(const Scan& scan) {
    const bool was_matched = std::exchange(is_laser_matched_, estimator_.newest().is_matched);
    if (!was_matched || !is_laser_matched_ || !laser_odometry_ || !scan.odometry) return;
    const std::size_t newest = estimator_.scan_count() - 1;
    mount_.add(inverse(transform_of(*laser_odometry_)) * transform_of(*scan.odometry),
               inverse(transform_of(estimator_.first_pose_of(newest - 1))) *
                   transform_of(estimator_.first_pose_of(newest)));
}

/// Returns where a scan is that is not from a laser.
RobotPoses::ScanAnchor RobotPoses::placed(const Scan& scan) const {
    const auto T_odom_robot = scan.odometry ? std::optional(transform_of(*scan.odometry)) : std::nullopt;
    if (laser_scans_.empty()) {
        const auto& map = estimator_.map();
        const bool is_alone = map.graph().size() == 0 && !map.is_frame_given(); // its odometry is the map's frame
        return {kNoLaserScan, T_odom_robot.value_or(Transform2()), scan.stamp, {}, is_alone};
    }
    if (!T_odom_robot || !laser_odometry_) return {estimator_.scan_count() - 1, {}, scan.stamp};
    return {estimator_.scan_count() - 1, inverse(transform_of(*laser_odometry_)) * *T_odom_robot, scan.stamp};
}

bool RobotPoses::note_moves() {
    const double move = largest_move();
    const std::size_t keyframes = estimator_.keyframes().size();
    const auto fragments = std::exchange(fragments_, estimator_.found_fragments());
    return fragments_ > fragments || is_worth_a_correction(move, keyframes, keyframes - keyframes_at_correction_);
}

void RobotPoses::correct() {
    const auto before = in_maps_.snapshot();
    mapping::EstimatedPoses after;
    for (std::size_t scan = 0; scan < scan_count(); ++scan) {
        std::optional<Pose2> pose = before[scan];
        if (is_located(scan)) follow(pose, newest(scan));
        after.append(pose);
    }
    in_maps_ = std::move(after);
    keyframes_in_maps_.clear();
    for (const std::size_t keyframe : estimator_.keyframes()) {
        keyframes_in_maps_.push_back(estimator_.map().graph().pose(keyframe));
    }
    keyframes_at_correction_ = keyframes_in_maps_.size();
    corrections_.push_back({scan_count(), estimator_.decided_count()});
}

/// Returns how far a keyframe or a decided scan is from its pose in the maps, at most. Looks at keyframes only after
/// the graph was optimized, and at scans only once.
double RobotPoses::largest_move() {
    double largest = 0.0;
    const auto& keyframes = estimator_.keyframes();
    if (keyframes_in_maps_.size() <
        keyframes.size()) { // the newest laser scan; the graph may have been optimized since
        keyframes_in_maps_.push_back(transform_of(estimator_.first_pose_of(estimator_.scan_count() - 1)));
    }
    for (; decided_ < estimator_.decided_count(); ++decided_) {
        const auto& shown = in_maps_.snapshot()[laser_scans_[decided_]];
        if (!shown || !estimator_.is_located(decided_)) continue;
        const auto estimate = transform_of(estimator_.pose_of(decided_));
        largest = std::max(largest, distance_between(transform_of(*shown), estimate));
    }
    if (optimizations_ == estimator_.map().optimization_count()) return largest;
    optimizations_ = estimator_.map().optimization_count();
    const auto& graph = estimator_.map().graph();
    for (std::size_t n = 0; n < keyframes.size(); ++n) {
        if (!graph.fragment_of(keyframes[n]).is_located) continue;
        largest = std::max(largest, distance_between(keyframes_in_maps_[n], graph.pose(keyframes[n])));
    }
    return largest;
}

Pose2 RobotPoses::newest(std::size_t scan) const {
    const ScanAnchor& placed = scans_[scan];
    if (placed.laser_scan == kExcluded) return {};
    if (placed.laser_scan == kNoLaserScan) return pose_of(placed.T_laser_scan);
    const Pose2 laser = estimator_.pose_of(placed.laser_scan);
    return laser_scans_[placed.laser_scan] == scan ? laser : pose_of(transform_of(laser) * placed.T_laser_scan);
}

bool RobotPoses::is_located(std::size_t scan) const {
    const ScanAnchor& placed = scans_[scan];
    if (placed.laser_scan == kExcluded) return false;
    return placed.laser_scan == kNoLaserScan ? placed.was_in_map : estimator_.is_located(placed.laser_scan);
}

bool RobotPoses::is_fragment_located(std::size_t scan) const {
    const ScanAnchor& placed = scans_[scan];
    if (placed.laser_scan == kExcluded) return false;
    return placed.laser_scan == kNoLaserScan ? placed.was_in_map : estimator_.is_fragment_located(placed.laser_scan);
}

LocalizationState RobotPoses::state() const {
    if (laser_scans_.empty()) return LocalizationState::kUnlocated;
    if (!estimator_.needs_place()) return LocalizationState::kTracking;
    return estimator_.located_fragments() == 0 ? LocalizationState::kUnlocated : LocalizationState::kLost;
}

mapping::Localization RobotPoses::localization() const {
    if (laser_scans_.empty()) return {.state = state()};
    const auto& newest = estimator_.newest();
    return {state(),           newest.inlier_ratio,     newest.position_sigma,
            newest.yaw_sigma,  estimator_.loop_count(), corrections_.size(),
            mount_.yaw_error()};
}

RobotHistory RobotPoses::history() const {
    RobotHistory history{.moments = corrections_, .laser_scans = {}, .scans = {}};
    for (std::size_t n = 0; n < estimator_.scan_count(); ++n) {
        const auto& [keyframe, T_keyframe_robot, is_matched] = estimator_.placement(n);
        history.laser_scans.push_back(
            {estimator_.first_pose_of(n), estimator_.was_located(n), keyframe, T_keyframe_robot, is_matched});
    }
    for (std::size_t n = 0; n < scans_.size(); ++n) {
        const ScanAnchor& scan = scans_[n];
        auto& added = history.scans.emplace_back();
        added.stamp = scan.stamp;
        added.revision = scan.revision;
        if (scan.was_shown) added.added = scan.first;
        if (scan.laser_scan == kNoLaserScan || scan.laser_scan == kExcluded) continue;
        added.laser_scan = scan.laser_scan;
        if (laser_scans_[scan.laser_scan] != n) added.T_laser_scan = scan.T_laser_scan;
    }
    return history;
}

} // namespace scanloom::localization
