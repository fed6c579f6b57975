#include "robot_client/sim/cell_shapes.hpp"

#include <algorithm>

namespace scanloom::robot {
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

} // namespace scanloom::robot
