#pragma once

#include "common/geometry/point_mm.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::robot {

/// The points that a stationary robot's lasers observed, added scan by scan.
///
/// Units: points in whole millimetres, otherwise metres.
/// Frames: that of Scan::pose or, without one, of Scan::odometry, i.e. the odometry frame of a robot that requests its
///         position. A scan without both was taken at the origin.
class SeenPoints {
public:
    /// Adds the returns of a scan. Beams without a return and points beyond kCoordinateMax are skipped. Pre: the sensor
    /// took the scan; its angles have one entry per range.
    void add(const Scan& scan, const Sensor& sensor);

    /// Returns all points, or kViewPointsMax selected evenly.
    [[nodiscard]] std::vector<PointMm> points() const;

    /// Returns the number of all points, also beyond kViewPointsMax.
    [[nodiscard]] std::size_t count() const noexcept { return points_.size(); }

    /// Returns the mean position of the sensors, in metres. Pre: a scan was added.
    [[nodiscard]] Point2 from() const;

private:
    std::vector<PointMm> points_;
    Point2 sum_of_places_{0.0, 0.0};
    std::size_t scans_ = 0;
};

} // namespace scanloom::robot
