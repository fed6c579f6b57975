#pragma once

#include "robot_client/sim/shapes.hpp"

#include <vector>

namespace scanloom::robot {

/// A person as a laser sees one: a disc that moves around a closed loop at constant speed.
struct Walker {
    std::vector<Point2> loop; ///< corners, metres; the last one connects to the first
    double radius = 0.25;     ///< metres
    double pace = 1.0;        ///< metres per second
    double walked = 0.0;      ///< metres since the first corner
};

/// Returns the walker's current disc. Pre: its loop has a length greater than 0.
[[nodiscard]] Disc body_of(const Walker& walker);

/// A walker does not come nearer than this to a robot's centre by itself; it waits until the robot has left.
inline constexpr double kWalkerDistance = 0.7; // metres

/// Moves the walker for some time, or lets it wait if it would come too near to the robot.
void walk(Walker& walker, const Point2& robot, double seconds);

} // namespace scanloom::robot
