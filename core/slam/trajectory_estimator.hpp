#pragma once

#include "core/scan_matching/scan_points.hpp"
#include "core/slam/keyframe_graph.hpp"
#include "core/slam/loop_search.hpp"
#include "core/slam/tracker.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace scanloom::slam {

/// Estimates where the scans of one robot were taken, from the scans and the robot's odometry, or from the scans alone.
///
/// Each scan is matched to the newest keyframes (Tracker); a scan becomes a keyframe when the robot has moved on. Where
/// the robot returns to a place, loop edges correct the trajectory (LoopSearch). The other scans follow their keyframe.
/// The map's frame is that of the first scan's robot.
///
/// Deterministic: equal scans give equal poses on every processor with IEEE 754 arithmetic.
/// Memory: grows with the trajectory: the pose of each scan, the points of each keyframe (up to 6 KB), and the map of every
///     fifth keyframe.
/// Cost: some hundred microseconds a scan; at every second keyframe also time in proportion to the number of keyframes;
///     a large loop closure takes some tenths of a second in one call.
/// Threads: one at a time.
class TrajectoryEstimator {
public:
    /// Adds the next scan.
    /// @param scan      its points
    /// @param odometry  T_odom_robot at the scan; nullopt: not known. Pre: finite
    void add(ScanPoints scan, const std::optional<Pose2>& odometry);

    /// Decides about the scans that are still open, and optimises once more, as at the end of a log.
    void finish();

    /// Returns the number of scans added.
    [[nodiscard]] std::size_t scan_count() const noexcept { return first_poses_.size(); }

    /// Returns the newest estimate of a scan's pose.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    /// @return T_map_robot
    [[nodiscard]] Pose2 pose_of(std::size_t scan) const;

    /// Returns the pose of a scan as it was estimated when the scan was added: T_map_robot.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] Pose2 first_pose_of(std::size_t scan) const { return scan_matching::pose_of(first_poses_[scan]); }

    /// Returns the number of scans that fitted no map; their poses are predictions.
    [[nodiscard]] std::size_t unmatched_count() const noexcept { return unmatched_count_; }

    /// Returns the keyframes and their edges.
    [[nodiscard]] const KeyframeGraph& graph() const noexcept { return graph_; }
    /// Returns the figures of the loop search.
    [[nodiscard]] const LoopFigures& loop_figures() const noexcept { return loops_.figures(); }

private:
    /// A scan and the keyframe that it follows.
    struct PlacedScan {
        std::size_t keyframe = 0;
        Transform2 T_keyframe_robot;
    };

    void place(const std::vector<TrackedScan>& scans);
    void add_keyframe(ScanPoints scan, const Transform2& T_newest_keyframe, bool is_matched);

    KeyframeGraph graph_;
    LoopSearch loops_;
    Tracker tracker_;
    std::vector<PlacedScan> placed_; // of the decided scans
    std::vector<Transform2> first_poses_;
    std::optional<Transform2> odometry_; // of the last scan
    std::size_t unmatched_count_ = 0;
};

} // namespace scanloom::slam
