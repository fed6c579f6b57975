#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "sim/drive/behaviour.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace scanloom::sim {

/// Remembers for three seconds the obstacles within a metre of the robot, because a laser that points ahead loses sight
/// of what is next to a turning robot.
class NearObstacles {
public:
    /// Adds the points of the scan. Call it once per control step.
    void see(const Senses& senses);

    /// Returns the obstacles, in metres in the map frame; one for each square of 5 cm.
    [[nodiscard]] std::vector<Point2> places() const;

private:
    struct Seen {
        Point2 place;
        int step;
    };

    std::map<std::pair<std::int64_t, std::int64_t>, Seen> seen_; // by square
    int step_ = 0;
};

/// Returns the nearest valid reading of each sector, for a sensor aligned with its robot's axis.
/// Pre: the sensor took the scan.
[[nodiscard]] SectorRanges sector_ranges(const Scan& scan, const Sensor& sensor);

/// Returns the end points of a scan's returns, in metres in the map frame.
/// Pre: the sensor took the scan; the scan contains the robot's pose in the map frame.
[[nodiscard]] std::vector<Point2> obstacles_of(const Scan& scan, const Sensor& sensor);

/// Smallest distance, in metres, that the robot's centre keeps from anything.
inline constexpr double kKeptClear = kBodyRadius + 0.02;

/// Returns how far, in metres, the body can move straight towards `yaw` (radians) before its centre comes nearer than
/// kKeptClear to a point of the scan; infinite if nothing is in the way. Points that are nearer than that already count
/// only where the body would touch them. The third-nearest distance is used, so noise does not stop the robot: any
/// object that is large enough to matter near the robot has many points.
[[nodiscard]] double free_ahead(const Senses& senses, double yaw);

/// Returns the highest speed, in metres per second, from which a robot that drives towards `yaw` (radians) stops in
/// time despite the delay of its scan.
[[nodiscard]] double safe_speed(const Senses& senses, double yaw);

} // namespace scanloom::sim
