#include "robot_client/sim/ray_casting.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace scanloom::robot {
namespace {

/// Share of a segment's length by which it is taken longer at both ends: rounding must not open a corner.
constexpr double kEndSlack = 1e-9;

double cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

} // namespace

std::vector<Segment> segments_near(std::span<const Segment> segments, const Point2& point, double radius) {
    std::vector<Segment> near;
    std::copy_if(segments.begin(), segments.end(), std::back_inserter(near),
                 [&](const Segment& segment) { return distance(segment, point) <= radius; });
    return near;
}

double cast_ray(std::span<const Segment> segments, const Point2& origin, double yaw_rad) {
    const Point2 direction{std::cos(yaw_rad), std::sin(yaw_rad)};
    double nearest = std::numeric_limits<double>::infinity();
    for (const Segment& segment : segments) {
        const Point2 along = segment.b - segment.a;
        const double determinant = cross(direction, along);
        if (determinant == 0.0) continue; // parallel: seen edge on, its neighbours at the corners stop the ray
        const Point2 to_segment = segment.a - origin;
        const double length = cross(to_segment, along) / determinant;
        if (length < 0.0 || length >= nearest) continue;
        const double share = cross(to_segment, direction) / determinant;
        if (share >= -kEndSlack && share <= 1.0 + kEndSlack) nearest = length;
    }
    return nearest;
}

} // namespace scanloom::robot
