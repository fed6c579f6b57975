#include "sim/ray_casting.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::sim {
namespace {

/// Each segment is extended at both ends by this share of its length, so that rounding does not open a corner.
constexpr double kEndSlack = 1e-9;

} // namespace

Ray::Ray(const Point2& from, double yaw_rad)
    : origin_x(from.x), origin_y(from.y), direction_x(std::cos(yaw_rad)), direction_y(std::sin(yaw_rad)) {}

double cast_ray(const Segment& segment, const Ray& ray, double nearest) noexcept {
    // origin + length * direction = a + share * (b - a), solved by Cramer's rule
    const double along_x = segment.bx - segment.ax;
    const double along_y = segment.by - segment.ay;
    const double determinant = ray.direction_x * along_y - ray.direction_y * along_x;
    if (determinant == 0.0) return nearest; // parallel: seen edge-on; its neighbours at the corners stop the ray
    const double to_x = segment.ax - ray.origin_x;
    const double to_y = segment.ay - ray.origin_y;
    const double length_part = to_x * along_y - to_y * along_x;
    const double share_part = to_x * ray.direction_y - to_y * ray.direction_x;
    // Most segments are behind the ray or clearly outside it, which can be decided without a division.
    constexpr double kClearly = 10.0 * kEndSlack;
    const double square = determinant * determinant;
    const double offset = share_part * determinant;
    if (length_part * determinant < 0.0 || offset < -kClearly * square || offset > (1.0 + kClearly) * square) {
        return nearest;
    }
    const double length = length_part / determinant;
    if (length < 0.0 || length >= nearest) return nearest;
    const double share = share_part / determinant;
    return share >= -kEndSlack && share <= 1.0 + kEndSlack ? length : nearest;
}

double cast_ray(std::span<const Segment> segments, const Point2& origin, double yaw_rad) {
    const Ray ray(origin, yaw_rad);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Segment& segment : segments) nearest = cast_ray(segment, ray, nearest);
    return nearest;
}

double cast_ray(const Disc& disc, const Point2& origin, double yaw_rad) {
    const Point2 to_centre = disc.centre - origin;
    const double along = to_centre.x * std::cos(yaw_rad) + to_centre.y * std::sin(yaw_rad);
    const double aside = to_centre.y * std::cos(yaw_rad) - to_centre.x * std::sin(yaw_rad);
    const double square = disc.radius * disc.radius - aside * aside;
    if (square < 0.0) return std::numeric_limits<double>::infinity();
    const double half_chord = std::sqrt(square);
    if (along >= half_chord) return along - half_chord;
    return along + half_chord >= 0.0 ? along + half_chord : std::numeric_limits<double>::infinity();
}

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

double cross(const Point2& a, const Point2& b) { return a.x * b.y - a.y * b.x; }

Point2 along(double yaw_rad) { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }

} // namespace

Cone::Cone(const Point2& apex_m, double yaw_rad, double aperture_rad)
    : apex(apex_m), yaw(yaw_rad), half(aperture_rad / 2.0), left_end(along(yaw_rad + half)),
      right_end(along(yaw_rad - half)) {
    assert(half < std::numbers::pi / 2.0); // so that the cone is the intersection of two half-planes
}

double distance_within(const Cone& cone, const Segment& segment) {
    const Point2 a = Point2{segment.ax, segment.ay} - cone.apex;
    const Point2 b = Point2{segment.bx, segment.by} - cone.apex;
    double begin = 0.0; // of the part inside, as shares of the segment
    double end = 1.0;
    const auto cut = [&](double at_a, double at_b) { // keeps the part where the value is not negative
        if (at_a < 0.0 && at_b < 0.0) end = -1.0;
        if (at_a < 0.0 && at_b >= 0.0) begin = std::max(begin, at_a / (at_a - at_b));
        if (at_a >= 0.0 && at_b < 0.0) end = std::min(end, at_a / (at_a - at_b));
    };
    cut(cross(cone.right_end, a), cross(cone.right_end, b));
    cut(cross(a, cone.left_end), cross(b, cone.left_end));
    if (begin > end) return kNever;
    const Point2 side = b - a;
    const double foot = std::clamp(-dot(a, side) / squared_norm(side), begin, end);
    return norm(a + foot * side);
}

double distance_within(const Cone& cone, const Disc& disc) {
    const Point2 to_centre = disc.centre - cone.apex;
    if (norm(to_centre) <= disc.radius) return 0.0;
    const bool looks_at_centre = cross(cone.right_end, to_centre) >= 0.0 && cross(to_centre, cone.left_end) >= 0.0;
    if (looks_at_centre) return norm(to_centre) - disc.radius;
    // From outside, the nearer a ray passes to a disc's centre, the shorter is its distance to the disc.
    return std::min(cast_ray(disc, cone.apex, cone.yaw + cone.half), cast_ray(disc, cone.apex, cone.yaw - cone.half));
}

} // namespace scanloom::sim
