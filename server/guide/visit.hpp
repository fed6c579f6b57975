#pragma once

#include "server/mapping/snapshot.hpp"

#include <numbers>
#include <optional>

namespace scanloom::guide {

/// When a robot counts as having been at its goal and having looked at what it was sent there for.
inline constexpr double kArrivedCells = 2.0;                     ///< a scan from so near was taken at the goal, or
                                                                 ///< from within the body's radius
inline constexpr double kLookingWithin = std::numbers::pi / 4.0; ///< radians: the heading is so near to the direction
inline constexpr double kOnTargetCells = 0.75;                   ///< nearer than this no direction leads to the target
inline constexpr double kLookingTakes = 5.0;                     ///< seconds, whatever the heading

/// A goal that a robot was given, in metres of the map frame.
struct Visit {
    Point2 goal{0.0, 0.0};              ///< where to stand
    Point2 target{0.0, 0.0};            ///< what to look at
    double arrival_radius = 0.0;        ///< metres; see arrival_radius()
    std::uint64_t scans_before = 0;     ///< RobotState::scan_count when it was given
    std::optional<double> asking_since; ///< stamp of the newest scan when the robot first asked from there for more
};

[[nodiscard]] double arrival_radius(double body_radius_m, double cell_size_m);

/// Whether the robot's newest scan was taken at the goal.
[[nodiscard]] bool is_there(const Visit& visit, const mapping::RobotState& robot);

/// Whether the robot has looked: its newest scan was taken at the goal, after the goal was given, and either it heads
/// towards the target, as seen from the goal or from where it stands (which differ where the target is near), or stands
/// in the target's cell; or its scans show that it has stood there for kLookingTakes since it first asked from there.
/// Headings are the robot's: of a sensor that looks elsewhere, the time alone tells.
[[nodiscard]] bool has_looked(const Visit& visit, const mapping::RobotState& robot, double cell_size_m);

} // namespace scanloom::guide
