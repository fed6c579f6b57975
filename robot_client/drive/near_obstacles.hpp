#pragma once

#include "robot_client/drive/behaviour.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace scanloom::robot {

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

} // namespace scanloom::robot
