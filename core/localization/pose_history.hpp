#pragma once

#include "common/scan/poses.hpp"
#include "common/scan/scan_filter.hpp"
#include "core/mapping/scan_poses.hpp"
#include "core/slam/trajectory_estimator.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::localization {

/// Lets a pose in the maps follow an estimate. A move below kSettled is left out.
/// @param shown     T_map_robot in the maps; nullopt: the scan is in none
/// @param estimate  T_map_robot
void follow(std::optional<Pose2>& shown, const Pose2& estimate);
inline constexpr double kSettled = 0.01; ///< metres; a turn of one radian counts as one metre

/// Returns how far two poses are from each other, metres; a turn of one radian counts as one metre.
[[nodiscard]] double distance_between(const slam::Transform2& a, const slam::Transform2& b);

/// The state of the pose graph at a correction of the maps.
struct GraphMoment {
    Revision revision = 0;                   ///< of the log entry at which the maps were corrected
    std::vector<slam::Transform2> keyframes; ///< T_map_keyframe
    std::vector<bool> is_located;            ///< by keyframe: whether its place in the map was known
};

/// The poses of one robot's scans at all moments. Other scans than those of lasers hang on a laser scan.
struct RobotHistory {
    /// The robot at a correction of the maps.
    struct Moment {
        std::size_t scans = 0;   ///< number of its scans
        std::size_t decided = 0; ///< number of its laser scans that hung on keyframes
    };

    /// A laser scan.
    struct LaserScan {
        Pose2 first;                       ///< T_map_robot as first estimated
        bool was_located = false;          ///< whether it was known then
        std::size_t keyframe = 0;          ///< on which it hangs when it is decided
        slam::Transform2 T_keyframe_robot; ///< where it is then
        bool is_matched = false;           ///< whether it fitted the map
    };

    /// A scan.
    struct Scan {
        double stamp = 0.0;                           ///< seconds
        Revision revision = 0;                        ///< of its log entry
        std::optional<Pose2> added;                   ///< T_map_robot in the maps when it was added; nullopt: in none
        std::optional<std::size_t> laser_scan;        ///< its number; nullopt: no laser scan was before,
                                                      ///< or it is excluded
        std::optional<slam::Transform2> T_laser_scan; ///< from that laser scan; nullopt: it is that scan
    };

    std::vector<Moment> moments;        ///< by correction, from the robot's first one to the newest
    std::vector<LaserScan> laser_scans; ///< oldest first
    std::vector<Scan> scans;            ///< of all sensors, oldest first
};

/// The poses at which the maps of earlier log entries showed the scans. A copy of what it needs; it does not change.
/// Threads: any.
class PoseHistory {
public:
    /// @param graph   by correction, oldest first
    /// @param robots  by RobotIndex; empty for robots that send poses
    PoseHistory(std::vector<std::shared_ptr<const GraphMoment>> graph, std::vector<RobotHistory> robots)
        : graph_(std::move(graph)), robots_(std::move(robots)) {}

    /// Returns the poses in the maps of the entries up to this revision.
    [[nodiscard]] mapping::ScanPoses at(Revision revision) const;

    /// Returns the poses in the maps of the entries before the first scan with a later stamp that is not excluded.
    /// @param stamp       seconds
    /// @param exclusions  of the session
    [[nodiscard]] mapping::ScanPoses before(double stamp, const Exclusions& exclusions) const;

private:
    [[nodiscard]] mapping::ScanPoses after(std::size_t corrections) const;
    [[nodiscard]] std::vector<std::optional<Pose2>> poses_of(const RobotHistory& robot, std::size_t corrections) const;

    std::vector<std::shared_ptr<const GraphMoment>> graph_;
    std::vector<RobotHistory> robots_;
};

} // namespace scanloom::localization
