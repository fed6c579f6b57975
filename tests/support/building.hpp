#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "core/scan_matching/scan_points.hpp"
#include "core/scan_matching/transform2.hpp"

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
    [[nodiscard]] double range(const Point2& from, const scan_matching::SinCos& direction) const;

    /// Returns a laser of 181 beams over the half circle ahead, 20 m.
    [[nodiscard]] static Sensor laser() {
        Sensor sensor;
        sensor.angles = UniformAngles{-std::numbers::pi / 2.0, std::numbers::pi / 180.0, 181};
        sensor.range_min = 0.05;
        sensor.range_max = 20.0;
        return sensor;
    }

    /// Returns the scan that the laser takes, with errors of the ranges evenly distributed in +- noise_m.
    [[nodiscard]] Scan scan(const Sensor& sensor, const Pose2& T_map_robot, double noise_m, std::mt19937& random) const;
};

} // namespace scanloom::testing_support
