#pragma once

#include "common/geometry/point2.hpp"

#include <cmath>
#include <numbers>

namespace scanloom {

/// Returns the same direction in (-pi, pi].
/// @param angle_rad  radians, finite
[[nodiscard]] inline double normalize_angle(double angle_rad) noexcept {
    const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
    return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

/// A pose in the plane and the rigid transform that it represents: `T_a_b` transforms points from frame b to frame a.
/// Metres; radians counter-clockwise. compose() and inverse() return a yaw in (-pi, pi].
struct Pose2 {
    double x = 0.0;   ///< metres, of the origin of frame b in frame a
    double y = 0.0;   ///< metres
    double yaw = 0.0; ///< radians, from the x axis of frame a to that of frame b

    friend bool operator==(const Pose2&, const Pose2&) = default;
};

/// Returns whether no coordinate and no angle is infinite or NaN.
[[nodiscard]] inline bool is_finite(const Pose2& pose) noexcept {
    return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw);
}

/// Returns T_a_c = T_a_b * T_b_c.
/// @param T_a_b  pose of frame b in frame a
/// @param T_b_c  pose of frame c in frame b
[[nodiscard]] inline Pose2 compose(const Pose2& T_a_b, const Pose2& T_b_c) noexcept {
    const double c = std::cos(T_a_b.yaw);
    const double s = std::sin(T_a_b.yaw);
    return {T_a_b.x + c * T_b_c.x - s * T_b_c.y, T_a_b.y + s * T_b_c.x + c * T_b_c.y,
            normalize_angle(T_a_b.yaw + T_b_c.yaw)};
}

/// Returns T_b_a.
/// @param T_a_b  pose of frame b in frame a
[[nodiscard]] inline Pose2 inverse(const Pose2& T_a_b) noexcept {
    const double c = std::cos(T_a_b.yaw);
    const double s = std::sin(T_a_b.yaw);
    return {-c * T_a_b.x - s * T_a_b.y, s * T_a_b.x - c * T_a_b.y, normalize_angle(-T_a_b.yaw)};
}

/// Transforms a point from frame b to frame a.
/// @param T_a_b    pose of frame b in frame a
/// @param point_b  metres, frame b
/// @return the same point, metres, frame a
[[nodiscard]] inline Point2 transform(const Pose2& T_a_b, const Point2& point_b) noexcept {
    const double c = std::cos(T_a_b.yaw);
    const double s = std::sin(T_a_b.yaw);
    return {T_a_b.x + c * point_b.x - s * point_b.y, T_a_b.y + s * point_b.x + c * point_b.y};
}

} // namespace scanloom
