#pragma once

#include "common/geometry/pose2.hpp"

#include <cmath>
#include <numbers>

namespace scanloom::lab {

/// The difference between a pose and the ground truth.
struct PoseError {
    double metres = 0.0;
    double radians = 0.0;

    [[nodiscard]] double millimetres() const noexcept { return 1e3 * metres; }
    [[nodiscard]] double degrees() const noexcept { return radians * 180.0 / std::numbers::pi; }
};

[[nodiscard]] inline PoseError pose_error(const Pose2& found, const Pose2& truth) {
    return {std::hypot(found.x - truth.x, found.y - truth.y), std::abs(normalize_angle(found.yaw - truth.yaw))};
}

} // namespace scanloom::lab
