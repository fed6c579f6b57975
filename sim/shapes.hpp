#pragma once

#include "common/geometry/pose2.hpp"
#include "common/ros_map/pgm.hpp"

#include <vector>

namespace scanloom::sim {

/// A straight segment that sensors see and robots collide with. Metres, in the world frame.
struct Segment {
    double ax = 0.0;
    double ay = 0.0;
    double bx = 0.0;
    double by = 0.0;

    friend bool operator==(const Segment&, const Segment&) = default;
};

/// A rectangle parallel to the axes. Metres, in the world frame.
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

/// A disc that sensors see and robots collide with. Metres, in the world frame.
struct Disc {
    Point2 centre{0.0, 0.0};
    double radius = 0.0;
};

/// Returns the smallest box that contains the shape.
[[nodiscard]] Box bounds_of(const Segment& segment) noexcept;
[[nodiscard]] inline const Box& bounds_of(const Box& box) noexcept { return box; }

/// Returns the smallest box that contains both.
[[nodiscard]] Box united(const Box& a, const Box& b) noexcept;

/// Returns the box with all its sides moved outwards.
[[nodiscard]] Box widened(const Box& box, double metres) noexcept;

/// Returns whether the shapes have a point in common, borders included.
[[nodiscard]] bool touch(const Segment& segment, const Box& box) noexcept;
[[nodiscard]] bool touch(const Box& a, const Box& b) noexcept;

/// Returns the distance in metres from a point to the shape; 0 inside a disc.
[[nodiscard]] double distance(const Segment& segment, const Point2& point);
[[nodiscard]] double distance(const Disc& disc, const Point2& point);

/// Position of a map's cells.
struct MapFrame {
    double resolution = 0.05; ///< metres per cell
    double origin_x = 0.0;    ///< metres; lower-left corner of cell (0, 0)
    double origin_y = 0.0;

    [[nodiscard]] double x(std::size_t column) const noexcept {
        return origin_x + static_cast<double>(column) * resolution;
    }
    [[nodiscard]] double y(std::size_t row) const noexcept { return origin_y + static_cast<double>(row) * resolution; }
};

/// Returns the cells of one kind as few boxes that do not overlap: runs of a row, merged with equal runs above.
[[nodiscard]] std::vector<Box> boxes_of(const MapCells& map, MapCell kind, const MapFrame& frame);

/// Returns the border of the occupied cells as maximal straight segments, with the occupied side on their left.
[[nodiscard]] std::vector<Segment> outlines_of(const MapCells& map, const MapFrame& frame);

} // namespace scanloom::sim
