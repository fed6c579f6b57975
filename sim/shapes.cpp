#include "sim/shapes.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::sim {

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

namespace {

/// Adjacent cells of a row; their box began at row `first_row`.
struct Run {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t first_row = 0;
};

std::vector<Run> runs_of(const MapCells& map, MapCell kind, std::size_t row) {
    std::vector<Run> runs;
    for (std::size_t column = 0; column < map.width; ++column) {
        if (map.cells[row * map.width + column] != kind) continue;
        if (runs.empty() || runs.back().end != column) runs.push_back({column, column, row});
        runs.back().end = column + 1;
    }
    return runs;
}

/// The occupied side of a border.
enum class Side { kNeither, kLeft, kRight };

/// Divides a line between cells into segments: calls side(n) for its positions n = 0, 1, ... count - 1, and draw(begin,
/// end, side) for each run of positions with the same occupied side.
template <class SideOf, class Draw>
void for_pieces(std::size_t count, SideOf&& side_of, Draw&& draw) {
    Side side = Side::kNeither;
    std::size_t begin = 0;
    for (std::size_t n = 0; n <= count; ++n) {
        const Side here = n < count ? side_of(n) : Side::kNeither;
        if (here == side) continue;
        if (side != Side::kNeither) draw(begin, n, side);
        side = here;
        begin = n;
    }
}

Side side(bool left, bool right) { return left == right ? Side::kNeither : left ? Side::kLeft : Side::kRight; }

} // namespace

std::vector<Box> boxes_of(const MapCells& map, MapCell kind, const MapFrame& frame) {
    std::vector<Box> boxes;
    std::vector<Run> open; // of the previous row, from left to right
    for (std::size_t row = 0; row <= map.height(); ++row) {
        auto runs = row < map.height() ? runs_of(map, kind, row) : std::vector<Run>{};
        auto next = runs.begin();
        for (const Run& above : open) {
            while (next != runs.end() && next->begin < above.begin) ++next;
            if (next != runs.end() && next->begin == above.begin && next->end == above.end) {
                next->first_row = above.first_row;
            } else {
                boxes.push_back({frame.x(above.begin), frame.y(above.first_row), frame.x(above.end), frame.y(row)});
            }
        }
        open = std::move(runs);
    }
    return boxes;
}

std::vector<Segment> outlines_of(const MapCells& map, const MapFrame& frame) {
    std::vector<Segment> outlines;
    const auto is_solid = [&](std::size_t column, std::size_t row) { // one column or row outside is -1 and not solid
        return column < map.width && row < map.height() && map.cells[row * map.width + column] == MapCell::kOccupied;
    };
    for (std::size_t row = 0; row <= map.height(); ++row) { // parallel to x: above is left
        for_pieces(
            map.width, [&](std::size_t n) { return side(is_solid(n, row), is_solid(n, row - 1)); },
            [&](std::size_t begin, std::size_t end, Side occupied) {
                if (occupied == Side::kRight) std::swap(begin, end);
                outlines.push_back({frame.x(begin), frame.y(row), frame.x(end), frame.y(row)});
            });
    }
    for (std::size_t column = 0; column <= map.width; ++column) { // parallel to y
        for_pieces(
            map.height(), [&](std::size_t n) { return side(is_solid(column - 1, n), is_solid(column, n)); },
            [&](std::size_t begin, std::size_t end, Side occupied) {
                if (occupied == Side::kRight) std::swap(begin, end);
                outlines.push_back({frame.x(column), frame.y(begin), frame.x(column), frame.y(end)});
            });
    }
    return outlines;
}

} // namespace scanloom::sim
