#pragma once

#include <algorithm>
#include <cmath>

namespace scanloom {

/// A point in the plane, or a vector from one point to another. Metres, unless its user states another unit.
struct Point2 {
    double x = 0.0;
    double y = 0.0;

    friend constexpr bool operator==(const Point2&, const Point2&) = default;

    constexpr Point2& operator+=(const Point2& other) noexcept {
        x += other.x;
        y += other.y;
        return *this;
    }

    constexpr Point2& operator-=(const Point2& other) noexcept {
        x -= other.x;
        y -= other.y;
        return *this;
    }

    constexpr Point2& operator*=(double scale) noexcept {
        x *= scale;
        y *= scale;
        return *this;
    }

    constexpr Point2& operator/=(double divisor) noexcept {
        x /= divisor;
        y /= divisor;
        return *this;
    }
};

[[nodiscard]] constexpr Point2 operator+(const Point2& a, const Point2& b) noexcept { return {a.x + b.x, a.y + b.y}; }
[[nodiscard]] constexpr Point2 operator-(const Point2& a, const Point2& b) noexcept { return {a.x - b.x, a.y - b.y}; }
[[nodiscard]] constexpr Point2 operator-(const Point2& a) noexcept { return {-a.x, -a.y}; }
[[nodiscard]] constexpr Point2 operator*(double scale, const Point2& a) noexcept { return {scale * a.x, scale * a.y}; }
[[nodiscard]] constexpr Point2 operator*(const Point2& a, double scale) noexcept { return {a.x * scale, a.y * scale}; }
[[nodiscard]] constexpr Point2 operator/(const Point2& a, double divisor) noexcept {
    return {a.x / divisor, a.y / divisor};
}

[[nodiscard]] constexpr double dot(const Point2& a, const Point2& b) noexcept { return a.x * b.x + a.y * b.y; }
[[nodiscard]] constexpr double squared_norm(const Point2& a) noexcept { return dot(a, a); }
[[nodiscard]] inline double norm(const Point2& a) noexcept { return std::sqrt(squared_norm(a)); }

/// The unit vector in the direction of `a`; `a` itself if its squared norm is 0.
[[nodiscard]] inline Point2 normalized(const Point2& a) noexcept {
    const double squared = squared_norm(a);
    return squared > 0.0 ? a / std::sqrt(squared) : a;
}

/// The larger absolute coordinate.
/// @param a  finite
[[nodiscard]] inline double max_abs(const Point2& a) noexcept { return std::max(std::abs(a.x), std::abs(a.y)); }

/// The corner with the smallest coordinates of the box around two points.
[[nodiscard]] constexpr Point2 min_corner(const Point2& a, const Point2& b) noexcept {
    return {std::min(a.x, b.x), std::min(a.y, b.y)};
}

/// The corner with the largest coordinates of the box around two points.
[[nodiscard]] constexpr Point2 max_corner(const Point2& a, const Point2& b) noexcept {
    return {std::max(a.x, b.x), std::max(a.y, b.y)};
}

[[nodiscard]] inline bool is_finite(const Point2& a) noexcept { return std::isfinite(a.x) && std::isfinite(a.y); }

} // namespace scanloom
