#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "robot_client/source/located.hpp"

#include <boost/asio/awaitable.hpp>

#include <functional>
#include <vector>

namespace scanloom::robot {

/// Asks where a robot is that has seen these points from there, all in its odometry frame, on maps that hold all its
/// scans so far.
/// Pre  20 to 32,768 points.
using Locate = std::function<boost::asio::awaitable<Result<Located>>(std::vector<PointMm> points, Point2 from)>;

} // namespace scanloom::robot
