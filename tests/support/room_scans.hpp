#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace scanloom::testing_support {

/// The reference laser: 684 beams over the half circle ahead, 5 m.
inline Sensor reference_laser() {
    Sensor laser;
    laser.id = 1;
    laser.angles = UniformAngles{-std::numbers::pi / 2, std::numbers::pi / 683, 684};
    laser.range_max = 5.0;
    return laser;
}

/// Returns the range of a ray from inside a 10 x 10 m room around the origin with four pieces of furniture.
inline double room_range(const Point2& from, double direction_rad) {
    struct Box {
        double left, bottom, right, top;
    };
    static constexpr std::array<Box, 5> boxes{{{-5, -5, 5, 5},
                                               {-4.2, 3.0, -2.4, 4.1},
                                               {3.1, -1.5, 4.0, 1.2},
                                               {-1.0, -4.4, 1.3, -3.6},
                                               {-0.4, -0.3, 0.4, 0.5}}};
    const double dx = std::cos(direction_rad);
    const double dy = std::sin(direction_rad);
    double nearest = HUGE_VAL;
    for (const auto& box : boxes) {
        const auto meet = [&](double distance, double across, double low, double high) {
            if (distance > 0.0 && across >= low && across <= high) nearest = std::min(nearest, distance);
        };
        for (const double x : {box.left, box.right}) {
            const double distance = (x - from.x) / dx;
            meet(distance, from.y + distance * dy, box.bottom, box.top);
        }
        for (const double y : {box.bottom, box.top}) {
            const double distance = (y - from.y) / dy;
            meet(distance, from.x + distance * dx, box.left, box.right);
        }
    }
    return nearest;
}

/// Returns scans of the reference laser on a round through the room, seq 1, 2, ..., with ranges rounded to the
/// millimetre.
inline std::vector<Scan> room_scans(std::size_t count) {
    const Sensor laser = reference_laser();
    std::vector<Scan> scans(count);
    for (std::size_t n = 0; n < count; ++n) {
        const double turn = 2 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(count);
        scans[n].seq = n + 1;
        scans[n].sensor = laser.id;
        scans[n].pose = {2.2 * std::cos(turn), 2.2 * std::sin(turn), normalize_angle(turn + std::numbers::pi / 2)};
        for (std::size_t beam = 0; beam < beam_count(laser.angles); ++beam) {
            const double direction = scans[n].pose->yaw + beam_angle(laser.angles, beam);
            const double range = room_range({scans[n].pose->x, scans[n].pose->y}, direction);
            scans[n].ranges.push_back(range < laser.range_max ? to_range_mm(range) : kNoReturn);
        }
    }
    return scans;
}

} // namespace scanloom::testing_support
