#pragma once

#include "tests/unit/core/slam/drive.hpp"

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace scanloom::slam {

/// Returns a hall of 14 x 9 m with two boxes, in which no place looks like one of ring_building().
inline testing_support::Building other_building() {
    testing_support::Building building;
    building.add_box(0.0, 0.0, 14.0, 9.0);
    building.add_box(3.0, 3.0, 5.0, 4.5);
    building.add_box(8.0, 5.0, 11.0, 6.0);
    return building;
}

/// Returns the drive of a robot around the hall of other_building(), with exact odometry.
inline const Drive& drive_in_other_building() {
    static const std::vector<Point2> around{{1.0, 1.0}, {13.0, 1.5}, {13.0, 8.0}, {6.0, 7.5}, {1.5, 8.0}, {1.0, 2.0}};
    static const Drive drive = drive_along(other_building(), around, {}, 5);
    return drive;
}

/// Returns what a robot sees on another floor: in a room of 8 x 6 m it turns on the spot, 0.05 rad between scans.
inline std::vector<Scan> turn_on_other_floor(const Sensor& laser, std::size_t scans, std::uint32_t seed) {
    testing_support::Building room;
    room.add_box(-3.0, -2.0, 5.0, 4.0);
    room.add_box(1.0, 1.0, 1.5, 1.6);
    std::mt19937 random(seed);
    std::vector<Scan> seen;
    for (std::size_t n = 0; n < scans; ++n) {
        seen.push_back(room.scan(laser, {0.3, 0.2, 0.05 * static_cast<double>(n)}, 0.01, random));
    }
    return seen;
}

/// Appends turn_on_other_floor() to a drive: the robot is carried there, and only its odometry notices the turn.
inline void carry_to_other_floor(Drive& drive, std::size_t scans, std::uint32_t seed) {
    for (Scan& scan : turn_on_other_floor(drive.laser, scans, seed)) {
        drive.odometry.push_back(compose(drive.odometry.back(), {0.0, 0.0, 0.05}));
        drive.scans.push_back(std::move(scan));
    }
}

} // namespace scanloom::slam
