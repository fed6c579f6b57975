#include "robot_client/drive/sectors.hpp"

#include "common/geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
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

std::vector<Point2> obstacles_of(const Scan& scan, const Sensor& sensor) {
    const BeamAngles angles = angles_of(scan, sensor);
    const Pose2 T_map_sensor = compose(scan.pose, sensor.mount);
    std::vector<Point2> obstacles;
    obstacles.reserve(scan.ranges.size());
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const RangeMm mm = scan.ranges[i];
        if (mm == kInvalidRange || mm == kNoReturn) continue;
        const double range = static_cast<double>(mm) / 1000.0;
        const double yaw = T_map_sensor.yaw + beam_angle(angles, i);
        obstacles.push_back({T_map_sensor.x + range * std::cos(yaw), T_map_sensor.y + range * std::sin(yaw)});
    }
    return obstacles;
}

} // namespace scanloom::robot
