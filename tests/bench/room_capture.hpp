#pragma once

#include "common/geometry/pose2.hpp"
#include "sim/range_sensors.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

namespace scanloom::bench {

/// Returns what a stationary lidar sees in the simulator's room, turn after turn: readings in whole millimetres in 360
/// fixed directions, so many points are equal.
/// @param place  of the lidar in the room
/// @param count  of points
/// @return points in the lidar's frame, metres
inline std::vector<Point2> capture(const Pose2& place, std::size_t count, std::uint64_t seed) {
    const auto room = sim::make_room();
    const Sensor laser = sim::find_laser("lidar360").value();
    sim::Random random(seed);
    std::vector<Point2> points;
    while (points.size() < count) {
        const auto ranges = sim::sweep(room, laser, place, sim::Noise{}, random);
        for (std::size_t n = 0; n < ranges.size() && points.size() < count; ++n) {
            if (ranges[n] == kInvalidRange || ranges[n] == kNoReturn) continue;
            const double angle = beam_angle(laser.angles, n);
            points.push_back(1e-3 * ranges[n] * Point2{std::cos(angle), std::sin(angle)});
        }
    }
    return points;
}

/// Returns capture() in the room's frame.
inline std::vector<Point2> capture_in_map(const Pose2& place, std::size_t count, std::uint64_t seed) {
    auto points = capture(place, count, seed);
    for (Point2& point : points) point = transform(place, point);
    return points;
}

} // namespace scanloom::bench
