#pragma once

#include "common/geometry/pose2.hpp"

namespace scanloom::robot {

/// A straight piece of something that sensors see and robots bump into. Metres, in the world frame.
struct Segment {
    double ax = 0.0;
    double ay = 0.0;
    double bx = 0.0;
    double by = 0.0;

    friend bool operator==(const Segment&, const Segment&) = default;
};

/// A rectangle along the axes. Metres, in the world frame.
struct Box {
    double x_min = 0.0;
    double y_min = 0.0;
    double x_max = 0.0;
    double y_max = 0.0;

    [[nodiscard]] bool contains(const Point2& point) const noexcept {
        return point.x >= x_min && point.x <= x_max && point.y >= y_min && point.y <= y_max;
    }

    friend bool operator==(const Box&, const Box&) = default;
};

/// Something round that sensors see and robots bump into. Metres, in the world frame.
struct Disc {
    Point2 centre{0.0, 0.0};
    double radius = 0.0;
};

/// The least box that holds the shape.
[[nodiscard]] Box bounds_of(const Segment& segment) noexcept;
[[nodiscard]] inline const Box& bounds_of(const Box& box) noexcept { return box; }

/// The least box that holds both.
[[nodiscard]] Box united(const Box& a, const Box& b) noexcept;

/// The box with all its sides moved outwards.
[[nodiscard]] Box widened(const Box& box, double metres) noexcept;

/// Whether they have a point in common, borders included.
[[nodiscard]] bool touch(const Segment& segment, const Box& box) noexcept;
[[nodiscard]] bool touch(const Box& a, const Box& b) noexcept;

/// Metres from a point to the nearest one of the shape; 0 inside a disc.
[[nodiscard]] double distance(const Segment& segment, const Point2& point);
[[nodiscard]] double distance(const Disc& disc, const Point2& point);

} // namespace scanloom::robot
