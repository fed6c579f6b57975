#pragma once

#include "common/geometry/pose2.hpp"

#include <span>

namespace scanloom::landmarks {

/// What was seen from one place, in some turns of a lidar that stood still.
struct CloudView {
    std::span<const Point2> points; ///< metres, in any frame
    Point2 from{0.0, 0.0};          ///< where the sensor was, in that frame
};

} // namespace scanloom::landmarks
