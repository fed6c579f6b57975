#include "robot_client/sim/cone.hpp"

#include "robot_client/sim/ray_casting.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::robot {
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

} // namespace scanloom::robot
