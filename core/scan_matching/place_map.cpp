#include "core/scan_matching/place_map.hpp"

#include <cmath>
#include <numbers>

namespace scanloom::scan_matching {
namespace {

constexpr double kCell = SeenSpace::kCell;
constexpr double kFacingTolerance = 0.5; // radians between the normals of a point and a surface
constexpr int kDirections = 8;           // that surfaces face

std::int32_t floor_of(double value) { return static_cast<std::int32_t>(std::floor(value)); }

} // namespace

PlaceMap::Bits PlaceMap::facing(const SurfacePoint& point, double direction, double tolerance) noexcept {
    if (!point.has_normal()) return (1U << kDirections) - 1;
    constexpr double kWidth = 2.0 * std::numbers::pi / kDirections;
    unsigned bits = 0;
    const auto first = floor_of((direction - tolerance) / kWidth);
    const auto last = floor_of((direction + tolerance) / kWidth);
    for (auto n = first; n <= last; ++n) bits |= 1U << static_cast<unsigned>(n & (kDirections - 1));
    return static_cast<Bits>(bits);
}

PlaceMap::PlaceMap(std::span<const View> views) {
    const SeenSpace space(views);
    corner_ = space.corner();
    cells_ = {static_cast<std::int32_t>(space.width()), static_cast<std::int32_t>(space.height()), {}};
    cells_.cells.reserve(static_cast<std::size_t>(space.width() * space.height()));
    for (std::int32_t row = 0; row < cells_.height; ++row) {
        for (std::int32_t column = 0; column < cells_.width; ++column) {
            const double x = corner_.x + (static_cast<double>(column) + 0.5) * kCell;
            const double y = corner_.y + (static_cast<double>(row) + 0.5) * kCell;
            cells_.cells.push_back(space.is_free(x, y) ? kPassed : kOpen);
        }
    }
    for (const View& view : views) {
        for (const SurfacePoint& point : view.points) {
            const SurfacePoint moved = transform(view.T_map_robot, point);
            const Bits bits = facing(moved, direction_of(moved), kFacingTolerance);
            const Point2 at = view.T_map_robot * Point2{point.x, point.y};
            const std::int32_t column = floor_of((at.x - corner_.x) / kCell);
            const std::int32_t row = floor_of((at.y - corner_.y) / kCell);
            for (std::int32_t j = row - 1; j <= row + 1; ++j) { // the space has a margin around all points
                for (std::int32_t i = column - 1; i <= column + 1; ++i) {
                    Bits& cell = cells_.cells[cells_.index_of(i, j)];
                    cell = static_cast<Bits>((cell | bits | kOpen) & ~kPassed);
                }
            }
        }
    }
    Grid grid = cells_;
    for (int n = 1; n < kLevels; ++n) {
        grid = merged(grid, 2, 2, 2);
        Squares& squares = bounds_.emplace_back();
        for (std::int32_t k = 0; k < 4; ++k) {
            squares[static_cast<std::size_t>(k)] = merged(grid, 1, 2 + k % 2, 2 + k / 2);
        }
    }
}

/// Merges rectangles of cells, at every `step`-th cell. The first one ends at the first cell if they overlap.
PlaceMap::Grid PlaceMap::merged(const Grid& grid, std::int32_t step, std::int32_t columns, std::int32_t rows) {
    const auto size_of = [&](std::int32_t size, std::int32_t count) { return (size + count - 1) / step; };
    const auto along = [&](std::int32_t size, std::int32_t count, std::int32_t lines, auto cell) {
        const std::int32_t before = count - step; // cells before the first one
        std::vector<Bits> result;
        for (std::int32_t line = 0; line < lines; ++line) {
            for (std::int32_t n = 0; n < size_of(size, count); ++n) {
                Bits bits = 0;
                for (std::int32_t k = 0; k < count; ++k) bits |= cell(n * step - before + k, line);
                result.push_back(bits);
            }
        }
        return result;
    };
    // By rows, then by columns; the first pass keeps its result by rows.
    const Grid wide{size_of(grid.width, columns), grid.height,
                    along(grid.width, columns, grid.height, [&](auto i, auto j) { return grid.at(i, j); })};
    const Grid turned{size_of(grid.height, rows), wide.width,
                      along(grid.height, rows, wide.width, [&](auto j, auto i) { return wide.at(i, j); })};
    Grid result{turned.height, turned.width, {}};
    result.cells.reserve(turned.cells.size());
    for (std::int32_t row = 0; row < result.height; ++row) {
        for (std::int32_t column = 0; column < result.width; ++column) result.cells.push_back(turned.at(row, column));
    }
    return result;
}

int PlaceMap::score_of(std::span<const SurfacePoint> points, const Transform2& T_map_points) const {
    int score = 0;
    for (const SurfacePoint& point : points) {
        if (point.x * point.x + point.y * point.y > kReach * kReach) continue;
        const SurfacePoint moved = transform(T_map_points, point);
        const Bits bits = cells_.at(floor_of((moved.x - corner_.x) / kCell), floor_of((moved.y - corner_.y) / kCell));
        score += (bits & facing(moved, direction_of(moved), 0.0)) != 0 ? 1 : (bits & kOpen) != 0 ? 0 : -1;
    }
    return score;
}

} // namespace scanloom::scan_matching
