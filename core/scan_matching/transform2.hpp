#pragma once

#include "common/geometry/pose2.hpp"

#include <cmath>

namespace scanloom::scan_matching {

/// The sine and the cosine of an angle.
struct SinCos {
    double sin = 0.0; ///< sine
    double cos = 1.0; ///< cosine

    friend bool operator==(const SinCos&, const SinCos&) = default;
};

/// Returns sine and cosine, equal on every processor. Those of the C library are not: it chooses among versions that
/// round differently.
/// @param angle_rad  radians, finite
/// @return within 1e-15 of the exact values for angles up to three turns
[[nodiscard]] SinCos sin_cos(double angle_rad) noexcept;

/// Returns the angle of the vector (x, y), equal on every processor.
/// @param y, x  finite
/// @return radians in [-pi, pi], within 5e-16 of the exact value; 0 for the null vector
[[nodiscard]] double angle_of(double y, double x) noexcept;

/// A rigid transform of the plane that keeps sine and cosine of its angle. Estimated poses are compositions of many
/// transforms; only additions and multiplications are needed for them, so equal inputs give equal bits on every
/// processor with IEEE 754 arithmetic. `T_a_b` transforms points from frame b to frame a.
struct Transform2 {
    double x = 0.0;    ///< metres, of the origin of frame b in frame a
    double y = 0.0;    ///< metres
    SinCos rotation{}; ///< of the angle from the x axis of frame a to that of frame b

    friend bool operator==(const Transform2&, const Transform2&) = default;
};

/// Returns whether the transform is one: its coordinates are finite, and its rotation has unit length up to 1e-3.
[[nodiscard]] inline bool is_finite(const Transform2& T_a_b) noexcept {
    const auto [s, c] = T_a_b.rotation;
    return std::isfinite(T_a_b.x) && std::isfinite(T_a_b.y) && std::fabs(s * s + c * c - 1.0) < 1e-3;
}

/// Converts a pose. Pre: it is finite.
[[nodiscard]] Transform2 transform_of(const Pose2& pose) noexcept;

/// Returns the pose, with a yaw in [-pi, pi].
[[nodiscard]] Pose2 pose_of(const Transform2& T_a_b) noexcept;

/// Returns the angle of the transform in radians, in [-pi, pi].
[[nodiscard]] inline double yaw_of(const Transform2& T_a_b) noexcept {
    return angle_of(T_a_b.rotation.sin, T_a_b.rotation.cos);
}

/// Returns the distance between the origins of the two frames, metres.
[[nodiscard]] inline double distance_of(const Transform2& T_a_b) noexcept {
    return std::sqrt(T_a_b.x * T_a_b.x + T_a_b.y * T_a_b.y);
}

/// Returns the rotation by the sum of two angles. The result has unit length again, so errors do not accumulate.
/// Precondition: both have unit length up to 1e-3.
[[nodiscard]] inline SinCos operator*(const SinCos& a, const SinCos& b) noexcept {
    const double s = a.sin * b.cos + a.cos * b.sin;
    const double c = a.cos * b.cos - a.sin * b.sin;
    const double scale = 1.5 - 0.5 * (s * s + c * c); // one Newton step to 1 / length
    return {s * scale, c * scale};
}

/// Returns T_a_c = T_a_b * T_b_c.
[[nodiscard]] inline Transform2 operator*(const Transform2& T_a_b, const Transform2& T_b_c) noexcept {
    const auto [s, c] = T_a_b.rotation;
    return {T_a_b.x + c * T_b_c.x - s * T_b_c.y, T_a_b.y + s * T_b_c.x + c * T_b_c.y, T_a_b.rotation * T_b_c.rotation};
}

/// Returns T_b_a.
[[nodiscard]] inline Transform2 inverse(const Transform2& T_a_b) noexcept {
    const auto [s, c] = T_a_b.rotation;
    return {-c * T_a_b.x - s * T_a_b.y, s * T_a_b.x - c * T_a_b.y, {-s, c}};
}

/// Returns a point of frame b in frame a. Metres.
[[nodiscard]] inline Point2 operator*(const Transform2& T_a_b, const Point2& point) noexcept {
    const auto [s, c] = T_a_b.rotation;
    return {T_a_b.x + c * point.x - s * point.y, T_a_b.y + s * point.x + c * point.y};
}

} // namespace scanloom::scan_matching
