#pragma once

#include "common/scan/poses.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "core/localization/mount_check.hpp"
#include "core/localization/pose_history.hpp"
#include "core/mapping/scan_poses.hpp"
#include "core/mapping/snapshot.hpp"
#include "core/slam/trajectory_estimator.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace scanloom::localization {

/// Returns whether maps follow what has moved since the last correction: by RobotPoses::kJump at once, by a cell of 5
/// cm after a pause, because each correction computes the maps of the whole log again.
/// @param move        metres: how far a keyframe or a scan moved, at most; a turn of one radian counts as one metre
/// @param keyframes   of the robot
/// @param since_then  keyframes of the robot since the last correction
[[nodiscard]] bool is_worth_a_correction(double move, std::size_t keyframes, std::size_t since_then) noexcept;

/// Where a robot is by its newest scan.
struct RobotLocation {
    Pose2 T_map_robot; ///< as estimated then
    Pose2 T_map_odom;  ///< of the odometry frame, by the newest scan with odometry; the identity: there is none
};

/// The poses of one robot's scans, estimated from the scans and its odometry.
///
/// A scan has three poses: as first estimated, when it was added; the newest estimate; and the one that maps show. Maps
/// show the first estimate until a correction is due (is_worth_a_correction()). Then they show the newest estimates.
/// What moved by less than kSettled stays. So the poses in the maps depend on the scans alone. The scans of other
/// sensors than lasers follow the newest laser scan, by the odometry since.
/// Threads: one at a time.
class RobotPoses {
public:
    static constexpr double kJump = 0.1; ///< metres; a turn of one radian counts as one metre

    /// @param map    that the robots of the session share; must outlive this object
    /// @param robot  number of the robot among them
    RobotPoses(slam::SharedMap& map, std::size_t robot) : estimator_(map, robot) {}

    /// Adds the robot's next scan.
    /// @param scan    with odometry if the robot has any
    /// @param sensor  that took it
    /// @param revision  of its log entry
    /// @return its pose in the maps, T_map_robot; nullopt: it fits no place, so maps leave it out
    std::optional<Pose2> add(const Scan& scan, const Sensor& sensor, Revision revision = 0);

    /// Adds the robot's next scan, which is excluded: it has no pose. Only the numbers of later scans depend on it.
    /// @param stamp     seconds
    /// @param revision  of its log entry
    void leave_out(double stamp, Revision revision);

    /// Searches for the robot's next laser scan near a place.
    void relocalize(const slam::Surroundings& place) { estimator_.relocalize(place); }

    /// Decides about the scans that are still open, before the map is frozen.
    void finish() { estimator_.finish(); }

    /// Looks at what has moved since the last call. Call it after each add() to the shared map.
    /// @return whether the maps should follow the newest estimates; true once for each reason
    [[nodiscard]] bool note_moves();

    /// Lets the maps follow the newest estimates.
    void correct();

    /// Returns the poses in the maps of all scans; nullopt: the scan is left out.
    [[nodiscard]] mapping::EstimatedPosesView in_maps() const { return in_maps_.snapshot(); }

    /// Returns the number of scans added, with the excluded ones: the newest Scan::seq.
    [[nodiscard]] std::size_t scan_count() const noexcept { return scans_.size(); }

    /// Returns the number of scans added that are not excluded.
    /// Cost: in proportion to scan_count().
    [[nodiscard]] std::size_t estimated_count() const noexcept;

    /// Returns the newest estimate of a scan's pose, T_map_robot, also if it fits no place; of an excluded scan the
    /// identity.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] Pose2 newest(std::size_t scan) const;

    /// Returns the pose of a scan as first estimated, T_map_robot.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] Pose2 first(std::size_t scan) const { return scans_[scan].first; }

    /// Returns whether a scan's place in the map was known when it was added, at least as a prediction.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool was_in_map(std::size_t scan) const { return scans_[scan].was_in_map; }

    /// Returns whether the scan's pose is known; see TrajectoryEstimator::is_located().
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool is_located(std::size_t scan) const;

    /// Returns where the robot is by its newest scan.
    [[nodiscard]] const RobotLocation& location() const noexcept { return location_; }

    /// Returns the stamp of a scan, seconds.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] double stamp(std::size_t scan) const { return scans_[scan].stamp; }

    /// Returns the revision of a scan's log entry.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] Revision revision(std::size_t scan) const { return scans_[scan].revision; }

    /// Returns whether a scan's place in the map is known, at least as a prediction.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool is_fragment_located(std::size_t scan) const;

    /// Returns how well the poses are known.
    [[nodiscard]] mapping::Localization localization() const;

    /// Returns its poses at all moments.
    [[nodiscard]] RobotHistory history() const;

    /// Returns the estimator of the laser scans.
    [[nodiscard]] const slam::TrajectoryEstimator& estimator() const noexcept { return estimator_; }

    /// Lists the members that decide later results; see common/archive.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.estimator_, self.scans_, self.laser_scans_, self.in_maps_, self.laser_odometry_, self.mount_,
                self.is_laser_matched_, self.location_, self.corrections_, self.keyframes_in_maps_,
                self.keyframes_at_correction_, self.optimizations_, self.decided_, self.fragments_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    /// @param corrections  of the session
    /// Precondition: the members of the map do.
    [[nodiscard]] bool is_consistent(const std::vector<std::shared_ptr<const GraphMoment>>& corrections) const;

private:
    static constexpr std::size_t kNoLaserScan = static_cast<std::size_t>(-1);
    static constexpr std::size_t kExcluded = static_cast<std::size_t>(-2);

    /// Where a scan is: relative to a laser scan.
    struct ScanAnchor {
        std::size_t laser_scan = kNoLaserScan; // number among the laser scans; kNoLaserScan: none was before;
                                               // kExcluded: nowhere, and the members about its pose are not used
        slam::Transform2 T_laser_scan;         // of the robot at both; without a laser scan T_map_robot
        double stamp = 0.0;                    // seconds
        Pose2 first;                           // T_map_robot, when it was added
        bool was_in_map = true;                // likewise
        bool was_shown = true;                 // in the maps, likewise
        Revision revision = 0;                 // of its log entry
    };

    [[nodiscard]] ScanAnchor placed(const Scan& scan) const;
    void check_mount(const Scan& scan);
    [[nodiscard]] double largest_move();
    [[nodiscard]] LocalizationState state() const;

    slam::TrajectoryEstimator estimator_;
    std::vector<ScanAnchor> scans_;
    std::vector<std::size_t> laser_scans_; // their numbers among all scans
    mapping::EstimatedPoses in_maps_;
    std::optional<Pose2> laser_odometry_; // of the newest laser scan
    MountCheck mount_;
    bool is_laser_matched_ = false; // whether that scan fitted the map
    RobotLocation location_;
    std::vector<RobotHistory::Moment> corrections_; // since its first scan

    // At the last correction, or since.
    std::vector<slam::Transform2> keyframes_in_maps_; // the poses of the robot's keyframes
    std::size_t keyframes_at_correction_ = 0;
    std::size_t optimizations_ = 0; // of the pose graph, that were looked at
    std::size_t decided_ = 0;       // laser scans that were looked at when they were decided
    std::size_t fragments_ = 0;     // located ones that the maps show
};

} // namespace scanloom::localization
