#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "core/scan_matching/scan_points.hpp"
#include "core/scan_matching/transform2.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace scanloom::testing_support {

/// Walls, and the scans that a laser takes among them. Computes without the C library's sine, so that scans are equal
/// on every processor.
class Building {
public:
    /// A straight wall between two points, in metres.
    struct Wall {
        Point2 from;
        Point2 to;
    };

    std::vector<Wall> walls;

    /// Adds the sides of a rectangle.
    void add_box(double left, double low, double right, double high) {
        walls.push_back({{left, low}, {right, low}});
        walls.push_back({{right, low}, {right, high}});
        walls.push_back({{right, high}, {left, high}});
        walls.push_back({{left, high}, {left, low}});
    }

    /// Returns the distance to the first wall, or infinity.
    [[nodiscard]] double range(const Point2& from, const scan_matching::SinCos& direction) const {
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

    /// Returns a laser of 181 beams over the half circle ahead, 20 m.
    [[nodiscard]] static Sensor laser() {
        Sensor sensor;
        sensor.angles = UniformAngles{-std::numbers::pi / 2.0, std::numbers::pi / 180.0, 181};
        sensor.range_min = 0.05;
        sensor.range_max = 20.0;
        return sensor;
    }

    /// Returns the scan that the laser takes, with errors of the ranges evenly distributed in +- noise_m.
    [[nodiscard]] Scan scan(const Sensor& sensor, const Pose2& T_map_robot, double noise_m,
                            std::mt19937& random) const {
        using namespace scan_matching;
        const Transform2 T_map_sensor = transform_of(T_map_robot) * transform_of(sensor.mount);
        Scan scan;
        for (std::size_t n = 0; n < beam_count(sensor.angles); ++n) {
            const SinCos direction = T_map_sensor.rotation * sin_cos(beam_angle(sensor.angles, n));
            const double range = this->range({T_map_sensor.x, T_map_sensor.y}, direction);
            const double error = noise_m * (2.0 * (static_cast<double>(random()) * 0x1p-32) - 1.0);
            scan.ranges.push_back(range < sensor.range_max ? to_range_mm(range + error) : kNoReturn);
        }
        return scan;
    }
};

/// Returns a number evenly distributed in [low, high), equal on every machine.
inline double uniform(std::mt19937& random, double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) * 0x1p-32);
}

} // namespace scanloom::testing_support
