#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "robot_client/source/located.hpp"

#include <boost/asio/awaitable.hpp>

#include <functional>
#include <vector>

namespace scanloom::robot {

/// Requests the position of a robot that saw these points from this place, both in its odometry frame, on maps that
/// contain all its scans so far.
/// Pre: 20 to 32,768 points.
using Locate = std::function<boost::asio::awaitable<Result<Located>>(std::vector<PointMm> points, Point2 from)>;

} // namespace scanloom::robot
