#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <boost/asio/awaitable.hpp>

#include <functional>
#include <vector>

namespace scanloom::robot {

/// The next exploration goal of a robot.
struct NextStop {
    enum class Outcome {
        kGoal,          ///< `path` leads to the next goal
        kTakenByOthers, ///< other robots drive to all goals that this robot can reach
        kComplete,      ///< no goal can be reached any more
    };
    Outcome outcome = Outcome::kComplete;
    std::vector<Point2> path; ///< with kGoal: path to the goal, metres in the map frame
    Point2 target{0.0, 0.0};  ///< with kGoal: the point to observe from the end of the path
};

/// Requests the next goal of a robot at the pose of its newest scan, on maps that contain all its scans so far. Paths
/// should keep the distance from obstacles that the robot needs to follow them.
using NextGoal = std::function<boost::asio::awaitable<Result<NextStop>>()>;

} // namespace scanloom::robot
