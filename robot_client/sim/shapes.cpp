#include "robot_client/sim/shapes.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::robot {

Box bounds_of(const Segment& segment) noexcept {
    return {std::min(segment.ax, segment.bx), std::min(segment.ay, segment.by), std::max(segment.ax, segment.bx),
            std::max(segment.ay, segment.by)};
}

Box united(const Box& a, const Box& b) noexcept {
    return {std::min(a.x_min, b.x_min), std::min(a.y_min, b.y_min), std::max(a.x_max, b.x_max),
            std::max(a.y_max, b.y_max)};
}

Box widened(const Box& box, double metres) noexcept {
    return {box.x_min - metres, box.y_min - metres, box.x_max + metres, box.y_max + metres};
}

bool touch(const Box& a, const Box& b) noexcept {
    return a.x_min <= b.x_max && b.x_min <= a.x_max && a.y_min <= b.y_max && b.y_min <= a.y_max;
}

// Separating axes: those of the box and the normal of the segment.
bool touch(const Segment& segment, const Box& box) noexcept {
    if (!touch(bounds_of(segment), box)) return false;
    const double along_x = segment.bx - segment.ax;
    const double along_y = segment.by - segment.ay;
    const double to_x = (box.x_min + box.x_max) / 2.0 - segment.ax;
    const double to_y = (box.y_min + box.y_max) / 2.0 - segment.ay;
    const double reach =
        (std::abs(along_y) * (box.x_max - box.x_min) + std::abs(along_x) * (box.y_max - box.y_min)) / 2.0;
    return std::abs(along_x * to_y - along_y * to_x) <= reach;
}

double distance(const Segment& segment, const Point2& point) {
    const double along_x = segment.bx - segment.ax;
    const double along_y = segment.by - segment.ay;
    const double to_x = point.x - segment.ax;
    const double to_y = point.y - segment.ay;
    const double share =
        std::clamp((to_x * along_x + to_y * along_y) / (along_x * along_x + along_y * along_y), 0.0, 1.0);
    return std::hypot(to_x - share * along_x, to_y - share * along_y);
}

double distance(const Disc& disc, const Point2& point) {
    return std::max(0.0, norm(point - disc.centre) - disc.radius);
}

} // namespace scanloom::robot
