#pragma once

#include <algorithm>
#include <cmath>

namespace scanloom {

/// A point in the plane, or a vector from one point to another. Metres, unless its user states another unit.
struct Point2 {
    double x = 0.0; ///< to the right in the map frame, ahead in a robot or sensor frame
    double y = 0.0; ///< up in the map frame, to the left in a robot or sensor frame

    friend constexpr bool operator==(const Point2&, const Point2&) = default;

    /// Adds a vector to this one.
    constexpr Point2& operator+=(const Point2& other) noexcept {
        x += other.x;
        y += other.y;
        return *this;
    }

    /// Subtracts a vector from this one.
    constexpr Point2& operator-=(const Point2& other) noexcept {
        x -= other.x;
        y -= other.y;
        return *this;
    }

    /// Multiplies both coordinates by a number.
    constexpr Point2& operator*=(double scale) noexcept {
        x *= scale;
        y *= scale;
        return *this;
    }

    /// Divides both coordinates by a number.
    constexpr Point2& operator/=(double divisor) noexcept {
        x /= divisor;
        y /= divisor;
        return *this;
    }
};

/// Returns the sum of two vectors.
[[nodiscard]] constexpr Point2 operator+(const Point2& a, const Point2& b) noexcept { return {a.x + b.x, a.y + b.y}; }
/// Returns the vector from `b` to `a`.
[[nodiscard]] constexpr Point2 operator-(const Point2& a, const Point2& b) noexcept { return {a.x - b.x, a.y - b.y}; }
/// Returns the opposite vector.
[[nodiscard]] constexpr Point2 operator-(const Point2& a) noexcept { return {-a.x, -a.y}; }
/// Returns the vector with both coordinates multiplied by a number.
[[nodiscard]] constexpr Point2 operator*(double scale, const Point2& a) noexcept { return {scale * a.x, scale * a.y}; }
/// Returns the vector with both coordinates multiplied by a number.
[[nodiscard]] constexpr Point2 operator*(const Point2& a, double scale) noexcept { return {a.x * scale, a.y * scale}; }
/// Returns the vector with both coordinates divided by a number.
[[nodiscard]] constexpr Point2 operator/(const Point2& a, double divisor) noexcept {
    return {a.x / divisor, a.y / divisor};
}

/// Returns the dot product of two vectors, in the square of their unit.
[[nodiscard]] constexpr double dot(const Point2& a, const Point2& b) noexcept { return a.x * b.x + a.y * b.y; }
/// Returns the squared length of a vector.
[[nodiscard]] constexpr double squared_norm(const Point2& a) noexcept { return dot(a, a); }
/// Returns the length of a vector.
[[nodiscard]] inline double norm(const Point2& a) noexcept { return std::sqrt(squared_norm(a)); }

/// Returns the unit vector in the direction of `a`, or `a` itself if its squared norm is 0.
[[nodiscard]] inline Point2 normalized(const Point2& a) noexcept {
    const double squared = squared_norm(a);
    return squared > 0.0 ? a / std::sqrt(squared) : a;
}

/// Returns the larger absolute coordinate.
/// @param a  finite
[[nodiscard]] inline double max_abs(const Point2& a) noexcept { return std::max(std::abs(a.x), std::abs(a.y)); }

/// Returns the corner with the smallest coordinates of the box around two points.
[[nodiscard]] constexpr Point2 min_corner(const Point2& a, const Point2& b) noexcept {
    return {std::min(a.x, b.x), std::min(a.y, b.y)};
}

/// Returns the corner with the largest coordinates of the box around two points.
[[nodiscard]] constexpr Point2 max_corner(const Point2& a, const Point2& b) noexcept {
    return {std::max(a.x, b.x), std::max(a.y, b.y)};
}

/// Returns whether neither coordinate is infinite or NaN.
[[nodiscard]] inline bool is_finite(const Point2& a) noexcept { return std::isfinite(a.x) && std::isfinite(a.y); }

} // namespace scanloom
