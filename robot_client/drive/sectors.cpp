#include "robot_client/drive/sectors.hpp"

#include "common/geometry/pose2.hpp"

#include <algorithm>
#include <numbers>

namespace scanloom::robot {

SectorRanges sector_ranges(const Scan& scan, const Sensor& sensor) {
    constexpr double kSectorBorder = std::numbers::pi / 6.0;
    constexpr double kSectorEnd = std::numbers::pi / 2.0 + 1e-9; // the outermost beam belongs to its sector
    const BeamAngles angles = angles_of(scan, sensor);
    SectorRanges nearest;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const RangeMm mm = scan.ranges[i];
        if (mm == kInvalidRange || mm == kNoReturn) continue;
        const double angle = normalize_angle(beam_angle(angles, i));
        if (angle < -kSectorEnd || angle > kSectorEnd) continue;
        double& sector = angle < -kSectorBorder ? nearest.right : angle > kSectorBorder ? nearest.left : nearest.front;
        sector = std::min(sector, static_cast<double>(mm) / 1000.0);
    }
    return nearest;
}

} // namespace scanloom::robot
