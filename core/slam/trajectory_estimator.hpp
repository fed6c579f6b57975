#pragma once

#include "core/scan_matching/deskew.hpp"
#include "core/scan_matching/scan_points.hpp"
#include "core/slam/shared_map.hpp"
#include "core/slam/tracker.hpp"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::slam {

/// Estimates where the scans of one robot were taken, from the scans and the robot's odometry, or from the scans alone.
///
/// Each scan is matched to the newest keyframes (Tracker); a scan becomes a keyframe when the robot has moved on. Where
/// the robot returns to a place, loop edges correct the trajectory (LoopSearch). The other scans follow their keyframe.
/// In the map's frame, the first scan of the first robot is at its odometry, or without odometry at the origin.
/// Several robots can share a map. The others, and robots that are lost because their scans fit no map for a while, are
/// located when enough of what they see is found in the map (FragmentSearch). Until then their poses are in frames of
/// their own.
/// In a frozen map, scans are matched to the map's keyframes around the robot, and no keyframes are added. Where the
/// map shows little, the robot's own last views help.
///
/// Deterministic: equal scans give equal poses on every processor with IEEE 754 arithmetic.
/// Memory: grows with the trajectory: the pose of each scan, and the points of each keyframe (up to 6 KB). Maps that scans
///     are matched to reach up to kMapRadius, whatever poses robots send.
/// Cost: some hundred microseconds a scan; at every second keyframe also time in proportion to the number of keyframes;
///     a large loop closure takes some hundredths of a second in one call.
/// Threads: one at a time for all estimators of a map.
class TrajectoryEstimator {
public:
    /// @param map    shared by the robots of a session; must outlive this object
    /// @param robot  number of the robot among them
    explicit TrajectoryEstimator(SharedMap& map, std::size_t robot = 0) : map_(map), robot_(robot) {}

    /// Adds the next scan. Where its beams have times (Scan::duration), it is de-skewed by the motion since the scan
    /// before: that of the odometry, else of the last estimates.
    /// Some scans show nothing new: those with too few points, and those with exactly the readings of the scan before,
    /// as some drivers send them, unless the odometry shows no motion. If there was nothing new for more than 1 s
    /// without odometry, or 4 s with it, and the next scan does not fit the map at the predicted place, the robot is
    /// lost at once: it may be anywhere.
    /// @param scan    with odometry if the robot has any. Pre: validated
    /// @param sensor  the laser that took it
    void add(const Scan& scan, const Sensor& sensor);

    /// Adds the next scan, which is not de-skewed.
    /// @param scan      its points
    /// @param odometry  T_odom_robot at the scan; nullopt: not known. Pre: finite
    /// @param seconds   since the scan before; 0: not known
    void add(ScanPoints scan, const std::optional<Pose2>& odometry, double seconds = 0.0) {
        place(std::move(scan), odometry, seconds);
    }

    /// Searches for the next scan near a place, which people know. If it is found there, the robot goes on from there;
    /// otherwise it is lost, and further scans are searched for there, too.
    /// @param place  in the map's frame
    void relocalize(const Surroundings& place) { relocalized_ = place; }

    /// Decides about the scans that are still open, as at the end of a log.
    void finish();

    /// Returns the number of scans added.
    [[nodiscard]] std::size_t scan_count() const noexcept { return first_.size(); }

    /// Returns the newest estimate of a scan's pose.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    /// @return T_map_robot
    [[nodiscard]] Pose2 pose_of(std::size_t scan) const;

    /// Returns the pose of a scan as it was estimated when the scan was added: T_map_robot.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] Pose2 first_pose_of(std::size_t scan) const { return scan_matching::pose_of(first_[scan].pose); }

    /// A scan and the keyframe that it follows.
    struct PlacedScan {
        std::size_t keyframe = 0;    ///< its index
        Transform2 T_keyframe_robot; ///< where the robot was
        bool is_matched = true;      ///< whether the scan fitted the map
    };

    /// Returns on which keyframe a scan hangs; without a match if that is not decided yet.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] PlacedScan placement(std::size_t scan) const {
        return scan < placed_.size() ? placed_[scan] : PlacedScan{.is_matched = false};
    }

    /// Returns whether a scan's pose was known when the scan was added.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool was_located(std::size_t scan) const { return first_[scan].is_matched; }

    /// Returns whether a scan's pose is known: the scan fitted the map, and its fragment is located. Otherwise the pose
    /// is a prediction, or in a frame of its own.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool is_located(std::size_t scan) const;

    /// Returns whether the scan's fragment is located, so that its pose is known at least as a prediction.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool is_fragment_located(std::size_t scan) const {
        return graph().fragment_of(scan < placed_.size() ? placed_[scan].keyframe : anchor_).is_located;
    }

    /// Returns whether the place of the robot in the map is not known: its fragment is not located, or the last scans
    /// fitted no map.
    [[nodiscard]] bool needs_place() const noexcept {
        return tracker_.unmatched() >= kLostAfter || !is_fragment_located();
    }

    /// Returns the newest match; see Tracker::newest(). Its position_sigma includes the drift since the last loop
    /// closure over ground that did not determine the position in all directions.
    [[nodiscard]] const TrackedScan& newest() const noexcept { return newest_; }

    /// Returns the number of scans whose poses are decided: they are only corrected with their keyframes. The others
    /// are the newest ones.
    [[nodiscard]] std::size_t decided_count() const noexcept { return placed_.size(); }

    /// Returns the number of the robot's fragments that are located.
    [[nodiscard]] std::size_t located_fragments() const noexcept {
        return static_cast<std::size_t>(
            std::ranges::count_if(fragments_, [&](std::size_t n) { return graph().fragments()[n].is_located; }));
    }

    /// Returns the number of the robot's fragments whose place was found, or that began the map.
    [[nodiscard]] std::size_t found_fragments() const noexcept { return located_fragments() - continued_; }

    /// Returns the indices of the robot's keyframes, oldest first.
    [[nodiscard]] const std::vector<std::size_t>& keyframes() const noexcept { return keyframes_; }

    /// Returns the number of scans that fitted no map; their poses are predictions.
    [[nodiscard]] std::size_t unmatched_count() const noexcept { return unmatched_count_; }

    /// Returns the number of loop edges to keyframes of the robot.
    [[nodiscard]] std::size_t loop_count() const noexcept {
        return static_cast<std::size_t>(std::ranges::count_if(graph().edges(), [&](const Edge& edge) {
            return edge.is_robust && graph().fragment_of(edge.to).robot == robot_;
        }));
    }

    /// Returns the map, which the robot may share with others.
    [[nodiscard]] const SharedMap& map() const noexcept { return map_; }

    /// Lists the members that decide later results; see common/archive. The map is not among them.
    template <class Self, class Archive>
    static void list(Self& self, Archive& archive) {
        archive(self.tracker_, self.fragments_, self.continued_, self.keyframes_, self.anchor_, self.T_anchor_start_,
                self.is_in_frozen_map_, self.own_views_, self.placed_, self.first_, self.newest_, self.odometry_,
                self.relocalized_, self.unmatched_count_, self.drift_variance_, self.loops_, self.hole_,
                self.equal_for_, self.repeats_, self.stamp_, self.seconds_, self.last_ranges_);
    }

    /// Returns whether the members fit together, as they always do unless they were read from damaged bytes.
    /// Precondition: those of the map do.
    [[nodiscard]] bool is_consistent() const;

private:
    static constexpr std::size_t kLostAfter = 20;      // scans in a row without a match
    static constexpr std::size_t kLocalKeyframes = 35; // newest ones that scans are matched to

    /// A scan's pose as it was estimated when the scan was added.
    struct FirstEstimate {
        Transform2 pose; // T_map_robot
        bool is_matched = true;
    };

    /// What the robot saw where the frozen map shows little.
    struct OwnView {
        std::shared_ptr<const ScanPoints> scan;
        Transform2 T_map_robot;
    };

    void place(ScanPoints scan, const std::optional<Pose2>& odometry, double seconds);
    [[nodiscard]] scan_matching::Motion motion_at(const Scan& scan) const;
    [[nodiscard]] std::optional<Transform2> odometry_motion(const std::optional<Transform2>& now, double seconds) const;
    void add_drift();
    void append_decided(const std::vector<TrackedScan>& scans);
    [[nodiscard]] TrackedScan since_start(TrackedScan scan) const;
    void begin_fragment(ScanPoints scan, const Transform2& T_map_robot,
                        const std::optional<Surroundings>& place = std::nullopt, bool is_tracked = false);
    void add_keyframe(ScanPoints scan, const Transform2& T_anchor_robot);
    void begin_tracking(const Transform2& T_map_robot);
    void begin_in_frozen_map(const Transform2& T_map_robot);
    void keep_view(ScanPoints scan, const TrackedScan& tracked);
    [[nodiscard]] Transform2 T_anchor_newest() const;
    void follow_freeze();
    [[nodiscard]] const KeyframeGraph& graph() const noexcept { return map_.graph(); }
    void begin_to_see(ScanPoints scan, const Transform2& motion);
    [[nodiscard]] bool is_fragment_blind() const;
    [[nodiscard]] bool is_fragment_located() const noexcept {
        return fragments_.empty() || graph().fragments()[fragments_.back()].is_located;
    }

    SharedMap& map_;
    std::size_t robot_;
    Tracker tracker_;
    std::vector<std::size_t> fragments_; // indices of the robot's fragments, oldest first
    std::size_t continued_ = 0;          // fragments that began at a place in the frozen map
    std::vector<std::size_t> keyframes_;
    std::size_t anchor_ = 0;         // the keyframe that the next scans are placed relative to
    Transform2 T_anchor_start_;      // where the robot was when it became the anchor
    bool is_in_frozen_map_ = false;  // whether it is one of the frozen map, else the robot's newest one
    std::deque<OwnView> own_views_;  // in the frozen map, oldest first
    std::vector<PlacedScan> placed_; // of the decided scans
    std::vector<FirstEstimate> first_;
    TrackedScan newest_;
    std::optional<Transform2> odometry_;      // of the last scan
    std::optional<Surroundings> relocalized_; // where the next scan is searched for
    std::size_t unmatched_count_ = 0;
    double drift_variance_ = 0.0; // square metres, until a loop is closed or a fragment begins
    std::size_t loops_ = 0;       // loop_count() at the newest keyframe
    std::size_t repeats_ = 0;     // scans in a row that equal the one before them
    double equal_for_ = 0.0;      // seconds of equal scans without odometry
    double hole_ = 0.0;           // seconds since the last scan that showed anything new

    // Of the scans that were added with their sensors.
    std::optional<double> stamp_; // of the last one, seconds
    double seconds_ = 0.0;        // between the last two
    std::vector<RangeMm> last_ranges_;
};

} // namespace scanloom::slam
