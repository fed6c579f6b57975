#pragma once

#include "robot_client/drive/behaviour.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace scanloom::robot {

/// Remembers for three seconds what stood within a metre of the robot: a laser that looks ahead loses sight of what is
/// beside a robot that turns.
class NearObstacles {
public:
    /// Takes what the scan shows, once each control step.
    void see(const Senses& senses);

    /// Where they are, metres in the map frame; one for each square of 5 cm.
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
