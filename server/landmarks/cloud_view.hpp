#pragma once

#include "common/geometry/pose2.hpp"

#include <span>

namespace scanloom::landmarks {

/// What a stationary lidar saw from one place in some turns.
struct CloudView {
    std::span<const Point2> points; ///< metres, in any frame
    Point2 from{0.0, 0.0};          ///< position of the sensor, in that frame
};

} // namespace scanloom::landmarks
