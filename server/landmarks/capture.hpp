#pragma once

#include "common/geometry/point_mm.hpp"
#include "common/scan/log_entry.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// A robot that has come so far from where its last capture began begins another.
inline constexpr double kCaptureDistance = 0.5; ///< metres
inline constexpr double kCaptureTurn = 0.6;     ///< radians, of the robot

/// As long as it is within these of where the capture began it stands still, and the capture goes on.
inline constexpr double kStillDistance = 0.03; ///< metres
inline constexpr double kStillTurn = 0.02;     ///< radians

/// A capture has so many scans at most: more of the same place tell little, and cost as much.
inline constexpr std::uint32_t kCaptureScansMax = 16;

/// A robot that stands looks again after so many seconds, of its scans' stamps, either way, as clocks are set back:
/// doors open, people go.
inline constexpr double kCaptureAgainAfter = 30.0;

/// What a robot saw from one place: one scan of a robot that drives on (a keyframe), up to kCaptureScansMax of one that
/// stands still.
struct Capture {
    Pose2 pose;         ///< T_map_robot, of the first scan
    double stamp = 0.0; ///< seconds, of the first scan
    Revision first = 0; ///< log entries of the first and the last of its scans
    Revision last = 0;
    std::uint32_t scans = 0;
    std::vector<PointMm> points; ///< map frame; where its lasers met something
    Point2 from{0.0, 0.0};       ///< metres, map frame: where the laser was that took the first scan

    friend bool operator==(const Capture&, const Capture&) = default;
};

[[nodiscard]] std::vector<Point2> in_metres(std::span<const PointMm> points);

/// Divides what the lasers of one robot see into captures, scan by scan: a fold, so that the same scans give the same
/// captures however they came.
/// Thread  one at a time.
class CaptureCutter {
public:
    /// Adds the next scan.
    /// @return the capture that has ended: it is full, or the robot has moved on
    /// Pre  the sensor is a laser, and the one that took the scan; revisions rise.
    [[nodiscard]] std::optional<Capture> add(const Scan& scan, const Sensor& sensor, Revision revision);

    /// Whether a scan that was taken there may change anything: told without its readings, as most change nothing.
    [[nodiscard]] bool needs(double stamp, const Pose2& pose) const noexcept;

    /// The capture that is being taken; null: none is, the last one has ended.
    [[nodiscard]] const Capture* open() const noexcept { return is_open_ ? &*newest_ : nullptr; }

private:
    [[nodiscard]] Capture end();

    std::optional<Capture> newest_;
    bool is_open_ = false;
};

} // namespace scanloom::landmarks
