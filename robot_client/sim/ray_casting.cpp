#include "robot_client/sim/ray_casting.hpp"

#include <cmath>
#include <limits>

namespace scanloom::robot {
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

} // namespace scanloom::robot
