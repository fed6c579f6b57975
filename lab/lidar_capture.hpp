#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/sim/noise.hpp"
#include "robot_client/sim/world.hpp"

#include <optional>
#include <span>
#include <vector>

namespace scanloom::lab {

/// Scans of a stationary lidar: successive turns, all from one pose.
struct LidarCapture {
    Sensor sensor;
    std::vector<Scan> scans; ///< seq 1, 2, ...
};

/// Simulates turns of the simulator's "lidar360": 360 beams, 12 m, ten turns per second.
[[nodiscard]] LidarCapture take_capture(const robot::World& world, const Pose2& T_map_lidar, std::size_t turns,
                                        const std::optional<robot::Noise>& noise, robot::Random& random);

/// Returns the points hit by the beams, in the robot's frame: turn by turn, within a turn in the order of the beams.
[[nodiscard]] std::vector<Point2> points_of(std::span<const Scan> scans, const Sensor& sensor);

/// Returns the points of points_of() in the map frame, by the scans' poses.
[[nodiscard]] std::vector<Point2> points_in_map(std::span<const Scan> scans, const Sensor& sensor);

} // namespace scanloom::lab
