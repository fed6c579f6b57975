#include "tests/support/building.hpp"

#include "tests/support/uniform.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace scanloom::testing_support {

double Building::range(const Point2& from, const scan_matching::SinCos& direction) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& wall : walls) {
        const double ex = wall.to.x - wall.from.x;
        const double ey = wall.to.y - wall.from.y;
        const double determinant = direction.cos * ey - direction.sin * ex;
        if (std::fabs(determinant) < 1e-12) continue;
        const double fx = wall.from.x - from.x;
        const double fy = wall.from.y - from.y;
        const double distance = (fx * ey - fy * ex) / determinant;
        const double part = (fx * direction.sin - fy * direction.cos) / determinant;
        if (distance > 0.0 && part >= 0.0 && part <= 1.0) nearest = std::min(nearest, distance);
    }
    return nearest;
}

Scan Building::scan(const Sensor& sensor, const Pose2& T_map_robot, double noise_m, std::mt19937& random) const {
    using namespace scan_matching;
    const Transform2 T_map_sensor = transform_of(T_map_robot) * transform_of(sensor.mount);
    Scan scan;
    for (std::size_t n = 0; n < beam_count(sensor.angles); ++n) {
        const SinCos direction = T_map_sensor.rotation * sin_cos(beam_angle(sensor.angles, n));
        const double range = this->range({T_map_sensor.x, T_map_sensor.y}, direction);
        const double error = noise_m * uniform(random, -1.0, 1.0);
        scan.ranges.push_back(range < sensor.range_max ? to_range_mm(range + error) : kNoReturn);
    }
    return scan;
}

} // namespace scanloom::testing_support
