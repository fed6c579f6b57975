#pragma once

#include "core/scan_matching/scan_points.hpp"
#include "core/slam/keyframe_graph.hpp"
#include "core/slam/loop_search.hpp"
#include "core/slam/tracker.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace scanloom::slam {

/// Estimates where the scans of one robot were taken, from the scans and the robot's odometry, or from the scans alone.
///
/// Each scan is matched to the newest keyframes (Tracker); a scan becomes a keyframe when the robot has moved on. Where
/// the robot returns to a place, loop edges correct the trajectory (LoopSearch). The other scans follow their keyframe.
/// In the map's frame, the first scan is at its odometry, or without odometry at the origin.
/// Scans that fit no map for a while start a new part of the trajectory, at a predicted pose. Its scans count as
/// located when a loop edge connects it with the parts before.
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
    [[nodiscard]] std::size_t scan_count() const noexcept { return first_.size(); }

    /// Returns the newest estimate of a scan's pose.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    /// @return T_map_robot
    [[nodiscard]] Pose2 pose_of(std::size_t scan) const;

    /// Returns the pose of a scan as it was estimated when the scan was added: T_map_robot.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] Pose2 first_pose_of(std::size_t scan) const { return scan_matching::pose_of(first_[scan].pose); }

    /// Returns whether a scan's pose is known: the scan fitted the map, and its part of the trajectory is connected
    /// with the first one. Otherwise the pose is a prediction, which may be far off.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool is_located(std::size_t scan) const;

    /// Returns whether the scan's part of the trajectory is connected with the first one, so that its pose is known at
    /// least as a prediction.
    /// @param scan  number of the scan, from 0. Precondition: scan < scan_count()
    [[nodiscard]] bool is_connected_scan(std::size_t scan) const {
        return is_connected(scan < placed_.size() ? placed_[scan].keyframe : graph_.size() - 1);
    }

    /// Returns whether the robot is lost: its part of the trajectory is not connected, or the last scans fitted no map.
    [[nodiscard]] bool is_lost() const noexcept {
        return tracker_.unmatched() >= kLost || (!parts_.empty() && !parts_.back().is_connected);
    }

    /// Returns the newest match; see Tracker::newest().
    [[nodiscard]] const TrackedScan& newest() const noexcept { return newest_; }

    /// Returns the number of scans whose poses are decided: they are only corrected with their keyframes. The others
    /// are the newest ones.
    [[nodiscard]] std::size_t decided_count() const noexcept { return placed_.size(); }

    /// Returns the number of parts of the trajectory that are connected with the first one, and the first one.
    [[nodiscard]] std::size_t connected_parts() const noexcept {
        return static_cast<std::size_t>(std::ranges::count(parts_, true, &Part::is_connected));
    }

    /// Returns the number of scans that fitted no map; their poses are predictions.
    [[nodiscard]] std::size_t unmatched_count() const noexcept { return unmatched_count_; }

    /// Returns the number of loop edges.
    [[nodiscard]] std::size_t loop_count() const noexcept {
        return static_cast<std::size_t>(std::ranges::count(graph_.edges(), true, &Edge::is_robust));
    }

    /// Returns the keyframes and their edges.
    [[nodiscard]] const KeyframeGraph& graph() const noexcept { return graph_; }
    /// Returns the figures of the loop search.
    [[nodiscard]] const LoopFigures& loop_figures() const noexcept { return loops_.figures(); }

private:
    static constexpr std::size_t kLost = 20; // scans in a row without a match

    /// A scan and the keyframe that it follows.
    struct PlacedScan {
        std::size_t keyframe = 0;
        Transform2 T_keyframe_robot;
        bool is_matched = true;
    };

    /// A scan's pose as it was estimated when the scan was added.
    struct FirstEstimate {
        Transform2 pose; // T_map_robot
        bool is_matched = true;
    };

    /// Successive keyframes that scans connect. The first part is connected; a later one if a loop edge leads to it
    /// from a connected part.
    struct Part {
        std::size_t first = 0; // keyframe
        bool is_connected = true;
    };

    void place(const std::vector<TrackedScan>& scans);
    void add_keyframe(ScanPoints scan, const Transform2& T_newest_keyframe, bool is_matched);
    [[nodiscard]] std::size_t part_of(std::size_t keyframe) const;
    [[nodiscard]] bool is_connected(std::size_t keyframe) const { return parts_[part_of(keyframe)].is_connected; }
    void connect_parts();

    KeyframeGraph graph_;
    LoopSearch loops_;
    Tracker tracker_;
    std::vector<PlacedScan> placed_; // of the decided scans
    std::vector<FirstEstimate> first_;
    std::vector<Part> parts_; // by `first`; at least one after the first scan
    TrackedScan newest_;
    std::optional<Transform2> odometry_; // of the last scan
    std::size_t unmatched_count_ = 0;
};

} // namespace scanloom::slam
