#include "robot_client/sim/ray_casting.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace scanloom::robot {
namespace {

/// Share of a segment's length by which it is taken longer at both ends: rounding must not open a corner.
constexpr double kEndSlack = 1e-9;

} // namespace

std::vector<Segment> segments_near(std::span<const Segment> segments, const Point2& point, double radius) {
    std::vector<Segment> near;
    std::copy_if(segments.begin(), segments.end(), std::back_inserter(near),
                 [&](const Segment& segment) { return distance(segment, point) <= radius; });
    return near;
}

double cast_ray(std::span<const Segment> segments, const Point2& origin, double yaw_rad) {
    const double direction_x = std::cos(yaw_rad);
    const double direction_y = std::sin(yaw_rad);
    const double origin_x = origin.x();
    const double origin_y = origin.y();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Segment& segment : segments) {
        // origin + length * direction = a + share * (b - a), solved by Cramer's rule
        const double along_x = segment.bx - segment.ax;
        const double along_y = segment.by - segment.ay;
        const double determinant = direction_x * along_y - direction_y * along_x;
        if (determinant == 0.0) continue; // parallel: seen edge on, its neighbours at the corners stop the ray
        const double to_x = segment.ax - origin_x;
        const double to_y = segment.ay - origin_y;
        const double length = (to_x * along_y - to_y * along_x) / determinant;
        if (length < 0.0 || length >= nearest) continue;
        const double share = (to_x * direction_y - to_y * direction_x) / determinant;
        if (share >= -kEndSlack && share <= 1.0 + kEndSlack) nearest = length;
    }
    return nearest;
}

double cast_ray(const Disc& disc, const Point2& origin, double yaw_rad) {
    const Point2 to_centre = disc.centre - origin;
    const double along = to_centre.x() * std::cos(yaw_rad) + to_centre.y() * std::sin(yaw_rad);
    const double aside = to_centre.y() * std::cos(yaw_rad) - to_centre.x() * std::sin(yaw_rad);
    const double square = disc.radius * disc.radius - aside * aside;
    if (square < 0.0) return std::numeric_limits<double>::infinity();
    const double half_chord = std::sqrt(square);
    if (along >= half_chord) return along - half_chord;
    return along + half_chord >= 0.0 ? along + half_chord : std::numeric_limits<double>::infinity();
}

} // namespace scanloom::robot
