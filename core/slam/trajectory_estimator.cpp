#include "core/slam/trajectory_estimator.hpp"

#include "common/scan/limits.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace scanloom::slam {
namespace {

// From the newest keyframe to the next one if the scan shows much that the map does not have.
constexpr double kNewSightDistance = 0.2; // metres
constexpr double kNewSightTurn = 0.1;     // radians
constexpr double kNewSightInliers = 0.6;  // of such a scan's points, those that fit the map, at most
constexpr double kKnownPlace = 1.5;       // metres from a keyframe of the frozen map that shows the place
constexpr double kKnownPlaceTurn = 0.5;   // radians, likewise
constexpr double kMotionMax = 10.0;       // metres between two scans; odometry that moves by more has started again
constexpr double kSpeedMax = 1.5;         // metres per second: more than kMotionMax is possible after a hole
constexpr double kRestart = 0.5;          // metres from the origin of odometry that has started again
constexpr double kConditioned = 0.01;     // conditioning of a match that determines the position in all directions
constexpr std::size_t kRepeatsMax = 10;   // of a scan, by its driver; more may be those of equal walls without noise
constexpr double kStill = 0.002;          // metres between two scans, or radians; more is motion
constexpr double kHole = 1.0;             // seconds without a scan that shows anything new, without odometry
constexpr double kLongHole = 4.0;         // seconds; odometry may be wrong over that time, too
constexpr double kHoleInliers = 0.5;      // of the first scan after a hole
constexpr double kLongHoleInliers = 0.8;  // likewise after a long one without odometry

bool is_keyframe_due(const TrackedScan& scan) {
    if (is_beyond(scan.T_keyframe_robot, kKeyframeDistance, kKeyframeTurn)) return true;
    return scan.inlier_ratio <= kNewSightInliers && is_beyond(scan.T_keyframe_robot, kNewSightDistance, kNewSightTurn);
}

/// Returns the share of a scan's points that must fit the map at the predicted place: after a hole in the scans, the
/// robot may be anywhere else. 0: there is no hole.
double inliers_wanted(double seconds, bool has_odometry) {
    if (seconds <= (has_odometry ? kLongHole : kHole)) return 0.0;
    return !has_odometry && seconds > kLongHole ? kLongHoleInliers : kHoleInliers;
}

} // namespace

void TrajectoryEstimator::add(const Scan& scan, const Sensor& sensor) {
    using namespace scan_matching;
    const Motion motion = motion_at(scan);
    const double seconds = stamp_ ? scan.stamp - *stamp_ : 0.0;
    repeats_ = scan.ranges == last_ranges_ ? repeats_ + 1 : 0;
    place(can_deskew(scan, sensor, motion) ? points_of(deskewed(scan, sensor, motion), sensor)
                                           : points_of(scan, sensor),
          scan.odometry, seconds);
    seconds_ = seconds;
    stamp_ = scan.stamp;
    last_ranges_ = scan.ranges;
}

/// Returns the motion before a scan that is not added yet, as far as it is known.
scan_matching::Motion TrajectoryEstimator::motion_at(const Scan& scan) const {
    if (!stamp_) return {};
    if (odometry_ && scan.odometry) {
        const Transform2 now = scan_matching::transform_of(*scan.odometry);
        return {scan_matching::pose_of(inverse(*odometry_) * now), scan.stamp - *stamp_};
    }
    return {scan_matching::pose_of(tracker_.velocity()), seconds_};
}

/// Returns T_last_robot by the odometry of the last two scans; nullopt if it is not known.
std::optional<Transform2> TrajectoryEstimator::odometry_motion(const std::optional<Transform2>& now,
                                                               double seconds) const {
    if (!odometry_ || !now) return std::nullopt;
    const Transform2 motion = inverse(*odometry_) * *now;
    const double distance = distance_of(motion);
    const bool is_possible =
        distance <= kMotionMax || (distance <= kSpeedMax * seconds && distance_of(*now) > kRestart);
    return is_possible ? std::optional(motion) : std::nullopt; // also if it is NaN
}

void TrajectoryEstimator::place(ScanPoints scan, const std::optional<Pose2>& odometry, double seconds) {
    const std::optional<Transform2> now =
        odometry ? std::optional(scan_matching::transform_of(*odometry)) : std::nullopt;
    const std::optional<Transform2> motion = odometry_motion(now, seconds);
    odometry_ = now;
    const bool shows_new = repeats_ == 0 && scan.points.size() >= kViewPointsMin;
    const bool is_still = repeats_ > 0 && motion && !is_beyond(*motion, kStill, kStill); // equal scans are right
    const bool may_be_still = repeats_ > 0 && !motion && scan.points.size() >= kViewPointsMin;
    if (may_be_still) equal_for_ += seconds;
    const double hole = std::exchange(hole_, shows_new ? 0.0 : hole_) + (is_still || may_be_still ? 0.0 : seconds);
    if (!shows_new) hole_ = hole;
    const bool is_sent_again = repeats_ > 0 && repeats_ <= kRepeatsMax && motion && is_beyond(*motion, kStill, kStill);
    if (is_sent_again) scan.points.clear(); // it was not taken again
    if (keyframes_.empty()) {
        const Transform2 start = graph().size() == 0 ? now.value_or(Transform2()) : Transform2();
        begin_fragment(std::move(scan), start, std::exchange(relocalized_, std::nullopt));
        first_.push_back({graph().pose(keyframes_.back()), is_fragment_located()});
        placed_.push_back({anchor_, T_anchor_newest()});
        newest_ = {{}, 1.0, true};
        return;
    }
    follow_freeze();
    if (scan.points.size() >= kViewPointsMin && is_fragment_blind() && !relocalized_) {
        return begin_to_see(std::move(scan), motion.value_or(Transform2()));
    }
    if (!is_fragment_located()) map_.continue_search(fragments_.back());
    std::optional<Surroundings> place_to_search;
    if (!scan.points.empty()) place_to_search = std::exchange(relocalized_, std::nullopt);
    const bool is_leaving = is_in_frozen_map_ && !map_.is_frozen();
    const auto is_due = [&](const TrackedScan& tracked) {
        return place_to_search || is_leaving || is_keyframe_due(since_start(tracked));
    };
    auto decided = tracker_.add(scan, motion, is_due);
    newest_ = decided.empty() ? tracker_.newest() : decided.back();
    add_drift();
    // After equal scans without odometry, the first scan that is matched decides: the robot may have stood.
    const bool is_decided = shows_new && newest_.is_matched;
    const double equal_for = is_decided ? std::exchange(equal_for_, 0.0) : 0.0;
    const bool is_lost_in_hole =
        shows_new && newest_.inlier_ratio < std::max(inliers_wanted(hole, motion.has_value()),
                                                     inliers_wanted(equal_for, motion.has_value()));
    if (is_lost_in_hole && decided.empty()) decided = tracker_.decide();
    const Transform2 first = graph().pose(anchor_) * newest_.T_keyframe_robot;
    first_.push_back({first, newest_.is_matched && !is_lost_in_hole && is_fragment_located()});
    if (decided.empty()) {
        relocalized_ = place_to_search; // it waits until the open scans are decided
        return;
    }
    append_decided(decided);
    const TrackedScan& last = decided.back();
    const bool is_elsewhere = place_to_search && (is_fragment_located() || !last.is_matched);
    const bool is_beyond_all = !is_near(first, {0.0, 0.0}, kEstimateMax);
    const bool is_new = (tracker_.unmatched() >= kLostAfter && !scan.points.empty()) || is_elsewhere || is_beyond_all ||
                        is_lost_in_hole;
    if (is_new) {
        const bool is_tracked = is_elsewhere && is_fragment_located() && last.is_matched && !is_beyond_all;
        begin_fragment(std::move(scan), is_beyond_all ? Transform2() : first, place_to_search, is_tracked);
    } else if (last.is_matched && is_due(last)) {
        if (place_to_search) map_.expect(fragments_.back(), *place_to_search);
        if (is_in_frozen_map_ && !is_leaving) {
            keep_view(std::move(scan), last);
            return begin_tracking(first);
        }
        add_keyframe(std::move(scan), last.T_keyframe_robot);
    } else {
        return;
    }
    placed_.back() = {anchor_, T_anchor_newest()};
    const bool is_found = is_fragment_located() && (is_new || !first_.back().is_matched);
    if (is_found) first_.back() = {graph().pose(keyframes_.back()), true};
}

/// Adds the drift variance to the position_sigma of the newest scan. The variance grows by that of each scan that does
/// not determine the position in all directions, as between two bare walls: later scans begin from there.
void TrajectoryEstimator::add_drift() {
    const bool is_certain = newest_.is_matched && newest_.conditioning >= kConditioned;
    if (is_certain && is_in_frozen_map_) drift_variance_ = 0.0; // the map has not drifted
    const double variance = newest_.position_sigma * newest_.position_sigma;
    if (!is_certain) drift_variance_ += variance;
    newest_.position_sigma = std::sqrt(is_certain ? drift_variance_ + variance : drift_variance_);
}

/// Adds the first scan of a fragment that later ones can be matched to, where the odometry says that it was taken.
void TrajectoryEstimator::begin_to_see(ScanPoints scan, const Transform2& motion) {
    finish();
    add_keyframe(std::move(scan), placed_.back().T_keyframe_robot * motion);
    first_.push_back({graph().pose(keyframes_.back()), is_fragment_located()});
    placed_.push_back({anchor_, T_anchor_newest()});
    newest_ = {{}, 1.0, true};
}

/// Returns whether no keyframe of the fragment shows enough to match a scan to it.
bool TrajectoryEstimator::is_fragment_blind() const {
    if (is_in_frozen_map_) return false;
    return std::ranges::all_of(graph().fragments()[fragments_.back()].keyframes, [&](std::size_t keyframe) {
        return graph()[keyframe].scan->points.size() < kViewPointsMin;
    });
}

void TrajectoryEstimator::finish() { append_decided(tracker_.decide()); }

void TrajectoryEstimator::append_decided(const std::vector<TrackedScan>& scans) {
    for (const TrackedScan& scan : scans) {
        placed_.push_back({anchor_, scan.T_keyframe_robot, scan.is_matched});
        if (!scan.is_matched) ++unmatched_count_;
    }
}

void TrajectoryEstimator::begin_fragment(ScanPoints scan, const Transform2& T_map_robot,
                                         const std::optional<Surroundings>& place, bool is_tracked) {
    keyframes_.push_back(graph().size());
    fragments_.push_back(map_.begin_fragment(robot_, std::move(scan), T_map_robot, place, is_tracked));
    drift_variance_ = 0.0;
    begin_tracking(graph().pose(keyframes_.back()));
}

/// Makes the newest scan a keyframe. @param T_anchor_robot  where it was taken
void TrajectoryEstimator::add_keyframe(ScanPoints scan, const Transform2& T_anchor_robot) {
    keyframes_.push_back(graph().size());
    if (is_in_frozen_map_) {
        fragments_.push_back(map_.continue_from(robot_, std::move(scan), anchor_, T_anchor_robot));
        ++continued_;
    } else {
        map_.add_keyframe(fragments_.back(), std::move(scan), T_anchor_robot);
        const std::size_t loops = loop_count();
        if (std::exchange(loops_, loops) != loops) drift_variance_ = 0.0;
    }
    begin_tracking(graph().pose(keyframes_.back()));
}

/// Returns the scan with its pose relative to where the robot was when the anchor was chosen.
TrackedScan TrajectoryEstimator::since_start(TrackedScan scan) const {
    if (is_in_frozen_map_) scan.T_keyframe_robot = inverse(T_anchor_start_) * scan.T_keyframe_robot;
    return scan; // otherwise it started at the anchor
}

/// Returns where the robot's newest keyframe is.
Transform2 TrajectoryEstimator::T_anchor_newest() const {
    if (anchor_ == keyframes_.back()) return {};
    return inverse(graph().pose(anchor_)) * graph().pose(keyframes_.back());
}

/// Tracks the next scans by the newest keyframes of the fragment, or in a frozen map by those around.
void TrajectoryEstimator::begin_tracking(const Transform2& T_map_robot) {
    is_in_frozen_map_ = map_.is_frozen() && is_fragment_located();
    if (is_in_frozen_map_) return begin_in_frozen_map(T_map_robot);
    own_views_.clear();
    anchor_ = keyframes_.back();
    const std::size_t newest = graph()[anchor_].position;
    const std::size_t first = newest + 1 - std::min(newest + 1, kLocalKeyframes);
    tracker_.begin(KeyframeMap(graph().views_around(anchor_, first, newest)), Transform2());
}

void TrajectoryEstimator::begin_in_frozen_map(const Transform2& T_map_robot) {
    anchor_ = graph().nearest(T_map_robot, [&](std::size_t n) { return graph().is_in_map(n); }).value();
    const Transform2 T_anchor_map = inverse(graph().pose(anchor_));
    T_anchor_start_ = T_anchor_map * T_map_robot;
    KeyframeViews views = graph().views_near(anchor_, kLocalKeyframes, T_anchor_start_);
    for (const OwnView& own : own_views_) views.add({.scan = own.scan}, T_anchor_map * own.T_map_robot);
    tracker_.begin(KeyframeMap(std::move(views)), T_anchor_start_);
}

/// Keeps a scan that shows much what the frozen map does not have, and those after it until the robot is back at a
/// place that the map shows.
void TrajectoryEstimator::keep_view(ScanPoints scan, const TrackedScan& tracked) {
    const Transform2& T = tracked.T_keyframe_robot;
    const bool is_all_round = graph().fragment_of(anchor_).robot == kNoRobot;
    const bool is_known_place =
        distance_of(T) <= kKnownPlace && (is_all_round || std::fabs(yaw_of(T)) <= kKnownPlaceTurn);
    const bool is_new_sight = tracked.inlier_ratio <= kNewSightInliers;
    if (is_known_place && !is_new_sight) {
        if (!own_views_.empty()) own_views_.pop_front();
        return;
    }
    if (!is_new_sight && own_views_.empty()) return;
    own_views_.push_back({std::make_shared<const ScanPoints>(std::move(scan)), graph().pose(anchor_) * T});
    if (own_views_.size() > kLocalKeyframes) own_views_.pop_front();
}

/// Goes on in the map if it was frozen since the last scan.
void TrajectoryEstimator::follow_freeze() {
    if (is_in_frozen_map_ || !map_.is_frozen() || !is_fragment_located()) return;
    finish();
    const PlacedScan& last = placed_.back();
    begin_tracking(graph().pose(last.keyframe) * last.T_keyframe_robot);
}

bool TrajectoryEstimator::is_located(std::size_t scan) const {
    if (scan >= placed_.size()) return first_[scan].is_matched;
    return placed_[scan].is_matched && graph().fragment_of(placed_[scan].keyframe).is_located;
}

Pose2 TrajectoryEstimator::pose_of(std::size_t scan) const {
    if (scan >= placed_.size()) return first_pose_of(scan);
    const PlacedScan& placed = placed_[scan];
    return scan_matching::pose_of(graph().pose(placed.keyframe) * placed.T_keyframe_robot);
}

} // namespace scanloom::slam
