#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <boost/asio/awaitable.hpp>

#include <functional>
#include <vector>

namespace scanloom::robot {

/// What a robot is to explore next.
struct NextStop {
    enum class Outcome {
        kGoal,          ///< there is somewhere to go
        kTakenByOthers, ///< other robots have all that this one can reach
        kComplete,      ///< nothing can be reached any more
    };
    Outcome outcome = Outcome::kComplete;
    std::vector<Point2> path; ///< with kGoal: the way there, metres in the map frame
    Point2 target{0.0, 0.0};  ///< with kGoal: what to look at from its end
};

/// Asks for the next stop of a robot that stands where its newest scan was taken, on maps that hold all its scans so
/// far. Ways should keep as far from obstacles as the robot needs to follow them.
using NextGoal = std::function<boost::asio::awaitable<Result<NextStop>>()>;

} // namespace scanloom::robot
