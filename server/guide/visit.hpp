#pragma once

#include "server/mapping/snapshot.hpp"

#include <numbers>
#include <optional>

namespace scanloom::guide {

/// These limits decide whether a robot has been at its goal and has observed its target.
inline constexpr double kArrivedCells = 2.0;                     ///< a scan this near was taken at the goal, or
                                                                 ///< one within the body's radius
inline constexpr double kLookingWithin = std::numbers::pi / 4.0; ///< radians between heading and direction
inline constexpr double kOnTargetCells = 0.75;                   ///< nearer to the target, the direction is ignored
inline constexpr double kLookingTakes = 5.0;                     ///< seconds at the goal, with any heading

/// A goal that was assigned to a robot. Metres, map frame.
struct Visit {
    Point2 goal{0.0, 0.0};              ///< where the robot should stand
    Point2 target{0.0, 0.0};            ///< what the robot should observe
    double arrival_radius = 0.0;        ///< metres; see arrival_radius()
    std::uint64_t scans_before = 0;     ///< RobotState::scan_count when the goal was assigned
    std::optional<double> asking_since; ///< stamp of the newest scan at the first request from the goal
};

/// Returns the distance from the goal within which a robot has arrived, in metres: the body's radius, at least
/// kArrivedCells cells.
[[nodiscard]] double arrival_radius(double body_radius_m, double cell_size_m);

/// Returns whether the robot's newest scan was taken at the goal.
[[nodiscard]] bool is_there(const Visit& visit, const mapping::RobotState& robot);

/// Returns whether the robot has observed its target.
///
/// It has if its newest scan was taken at the goal after the goal was assigned, and one of these holds:
/// - The robot faces the target, as seen from the goal or from the robot (the two differ if the target is near).
/// - The robot stands in the target's cell.
/// - The robot's scans show that it has stood at the goal for kLookingTakes since it first asked from there.
///
/// The heading is that of the robot. For a sensor that looks elsewhere, only the time counts.
[[nodiscard]] bool has_looked(const Visit& visit, const mapping::RobotState& robot, double cell_size_m);

} // namespace scanloom::guide
