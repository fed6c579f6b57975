#pragma once

#include "common/geometry/point_mm.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::robot {

inline constexpr std::size_t kSeenPointsMin = 20; ///< of fewer no server tells where they were seen
inline constexpr std::size_t kSeenPointsMax = 32'768;

/// Where the lasers of a robot that stands met something, scan by scan.
///
/// Frames  that of Scan::pose: the odometry frame of a robot that asks where it is.
/// Units   points in whole millimetres; metres.
class SeenPoints {
public:
    /// Beams that met nothing, and what lies beyond kCoordinateMax, are passed over.
    /// Pre  the sensor took the scan; its angles have one entry per range.
    void add(const Scan& scan, const Sensor& sensor);

    /// All of them, or kSeenPointsMax taken evenly from all.
    [[nodiscard]] std::vector<PointMm> points() const;

    /// Of all, also of those beyond kSeenPointsMax.
    [[nodiscard]] std::size_t count() const noexcept { return points_.size(); }

    /// The middle of where the sensors were. Pre  a scan was added.
    [[nodiscard]] Point2 from() const;

private:
    std::vector<PointMm> points_;
    Point2 sum_of_places_{0.0, 0.0};
    std::size_t scans_ = 0;
};

} // namespace scanloom::robot
