#pragma once

#include "robot_client/sim/shapes.hpp"

#include <vector>

namespace scanloom::robot {

/// A person as lasers see one: a disc that goes round a closed path at a steady pace.
struct Walker {
    std::vector<Point2> loop; ///< corners, metres; the way leads from the last back to the first
    double radius = 0.25;     ///< metres
    double pace = 1.0;        ///< metres a second
    double walked = 0.0;      ///< metres since the first corner
};

/// Where the walker is now. Pre: its loop has a length.
[[nodiscard]] Disc body_of(const Walker& walker);

/// Nearer than this to a robot's centre a walker does not come by itself; from there on it waits until the robot is
/// gone.
inline constexpr double kWalkerDistance = 0.7; // metres

/// Lets the walker go on for some time, or wait where that would bring it too near to the robot.
void walk(Walker& walker, const Point2& robot, double seconds);

} // namespace scanloom::robot
