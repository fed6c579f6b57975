#pragma once

#include "common/geometry/point_mm.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/scan_filter.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace scanloom::landmarks {

/// A robot starts its next keyframe this far from where the last one started.
inline constexpr double kCaptureDistance = 0.5; ///< metres
inline constexpr double kCaptureTurn = 0.6;     ///< radians, of the robot

/// A robot within these limits of where a keyframe started is stationary, and the keyframe continues.
inline constexpr double kStillDistance = 0.03; ///< metres
inline constexpr double kStillTurn = 0.02;     ///< radians

/// The most scans of a keyframe: more scans of the same place add little and cost as much.
inline constexpr std::uint32_t kCaptureScansMax = 16;

/// A stationary robot starts another keyframe after this many seconds of its scans' stamps, because doors open and
/// people leave. The difference counts in either direction, because clocks may be set back.
inline constexpr double kCaptureAgainAfter = 30.0;

/// A keyframe: what a robot saw from one place, in one scan of a robot that drives on or up to kCaptureScansMax of a
/// stationary robot.
struct Capture {
    Pose2 pose;                  ///< T_map_robot, of the first scan
    double stamp = 0.0;          ///< seconds, of the first scan
    Revision first = 0;          ///< log entries of the first and the last of its scans
    Revision last = 0;           ///< likewise
    std::uint32_t scans = 0;     ///< 1 to kCaptureScansMax
    std::vector<PointMm> points; ///< map frame; where the laser beams hit something
    Point2 from{0.0, 0.0};       ///< metres, map frame: position of the laser at the first scan

    friend bool operator==(const Capture&, const Capture&) = default;
};

/// Converts points from millimetres to metres.
[[nodiscard]] std::vector<Point2> in_metres(std::span<const PointMm> points);

/// Divides the laser scans of one robot into keyframes, scan by scan. The same scans give the same keyframes, however
/// they arrived.
/// Threads: one at a time.
class CaptureCutter {
public:
    /// Adds the next scan.
    /// @param scan      the robot's next integrated laser scan
    /// @param sensor    the laser that took it
    /// @param revision  of the scan's log entry
    /// @return the keyframe that ended, because it is full or the robot moved on; nullopt: none ended
    /// Precondition: `sensor` is a laser and took the scan; revisions increase.
    [[nodiscard]] std::optional<Capture> add(const Scan& scan, const Sensor& sensor, Revision revision);

    /// Returns whether a scan taken there may change anything. The readings are not needed to know, and most scans
    /// change nothing.
    /// @param stamp  seconds
    /// @param pose   T_map_robot
    [[nodiscard]] bool needs(double stamp, const Pose2& pose) const noexcept;

    /// Returns the keyframe in progress, or nullptr if the last one has ended.
    [[nodiscard]] const Capture* open() const noexcept { return is_open_ ? &*newest_ : nullptr; }

private:
    [[nodiscard]] Capture end();

    std::optional<Capture> newest_;
    bool is_open_ = false;
};

/// A keyframe and the robot that it is from.
struct RobotCapture {
    RobotIndex robot = 0; ///< index in the session
    Capture capture;      ///< what it saw
    Revision ended = 0;   ///< log entry at which it ended: its last scan, or a later one if the robot moved on

    friend bool operator==(const RobotCapture&, const RobotCapture&) = default;
};

/// Divides a session's log, entry by entry, into the keyframes of its robots.
/// Threads: one at a time.
class SessionCaptures {
public:
    /// @param filter  selects the scans that are integrated in the session's maps; keyframes contain no others
    explicit SessionCaptures(ScanFilter filter = ScanFilter()) : filter_(std::move(filter)) {}

    /// Returns the revision of the last entry added or skipped.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Returns whether a scan, as the next entry, may change anything. The readings are not needed to know. If it
    /// returns false, call pass_over() instead of add().
    /// @param scan  the next entry of the log
    [[nodiscard]] bool needs(const ScanPose& scan) const noexcept {
        if (filter_.use_of(revision_ + 1, scan) != ScanUse::kIntegrated) return false;
        return scan.robot >= cutters_.size() || cutters_[scan.robot].needs(scan.stamp, *scan.pose);
    }
    /// Skips the next entry.
    /// @param scan  the next entry of the log, for which needs() returned false
    void pass_over(const ScanPose& scan) { filter_.take(++revision_, scan); }

    /// Adds the next entry. A scan of a sensor that was never described is skipped: only a damaged log contains one.
    /// @param entry  the next entry of the log
    /// @return the keyframe that ended with this entry; nullopt: none ended
    [[nodiscard]] std::optional<RobotCapture> add(const LogEntry& entry);

    /// Returns the keyframes in progress, by robot, as if they ended now.
    [[nodiscard]] std::vector<RobotCapture> open() const;

private:
    std::vector<CaptureCutter> cutters_;                             // by RobotIndex
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors_; // by robot and id, as last described
    ScanFilter filter_;
    Revision revision_ = 0;
};

} // namespace scanloom::landmarks
