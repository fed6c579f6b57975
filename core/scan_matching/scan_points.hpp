#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace scanloom::scan_matching {

/// A point of a surface that a laser beam hit, with the surface's normal where neighbouring beams hit a line.
struct SurfacePoint {
    float x = 0.0F;        ///< metres
    float y = 0.0F;        ///< metres
    float normal_x = 0.0F; ///< of a unit vector towards the laser; the null vector: unknown
    float normal_y = 0.0F; ///< likewise

    /// Returns whether the normal is known.
    [[nodiscard]] bool has_normal() const noexcept { return normal_x != 0.0F || normal_y != 0.0F; }

    friend bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
};

/// Returns whether no coordinate is infinite or NaN.
[[nodiscard]] inline bool is_finite(const SurfacePoint& point) noexcept {
    return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.normal_x) &&
           std::isfinite(point.normal_y);
}

/// What one scan shows: the points that its beams hit, in the robot's frame.
struct ScanPoints {
    std::vector<SurfacePoint> points; ///< in the order of the beams, at most kScanPointsMax
    Point2 laser{0.0, 0.0};           ///< metres, where the beams start
};

inline constexpr std::size_t kScanPointsMax = 400; ///< of more hits, every second, third... is taken

// Together they bound the distance of points from their robot, and so the memory of maps.
inline constexpr double kHitDistanceMax = 30.0;   ///< metres from the laser
inline constexpr double kMountDistanceMax = 20.0; ///< metres from the robot's origin to its laser

/// Returns whether the points and the laser are as near to the robot as those of points_of().
[[nodiscard]] bool are_in_reach(const ScanPoints& scan) noexcept;

/// Returns the points that a scan's beams hit. Readings without a return, and hits beyond kHitDistanceMax, are left
/// out: beams are too far apart there to show a surface. A laser beyond kMountDistanceMax has no points: no robot is so
/// large.
/// @param scan    its readings
/// @param sensor  the laser that took it, with its mount
/// Precondition: the sensor is a laser, and the scan is validated: explicit angles have one entry per range.
[[nodiscard]] ScanPoints points_of(const Scan& scan, const Sensor& sensor);

} // namespace scanloom::scan_matching
