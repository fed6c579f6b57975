#include "core/localization/known_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

namespace scanloom::localization {
namespace {

using classify::CellClass;
using scan_matching::SinCos;

constexpr double kSpacing = 2.0;           // metres between views
constexpr double kClearance = 0.3;         // metres around a view that are free
constexpr double kReach = 15.0;            // metres
constexpr std::uint32_t kBeams = 360;      // of a view
constexpr std::size_t kHitsMin = 20;       // of a view
constexpr double kStep = 0.5;              // cells along a beam
constexpr std::int32_t kSquaresOfTile = 4; // views of a tile of this side are neighbours

/// The cells of a part of a map in one array.
class Cells {
public:
    Cells(const classify::ClassView& classes, const grid::CellBox& box)
        : box_(box), cells_(static_cast<std::size_t>(box.width() * box.height()), CellClass::kUnexplored) {
        classes.visit(grid::chunks_of(box), 0, [&](grid::ChunkKey key, const classify::ClassChunk& chunk) {
            const grid::Cell corner{key.ci * grid::kChunkSide, key.cj * grid::kChunkSide};
            const auto inside = [&](std::int32_t begin, std::int32_t first, std::int32_t end) {
                return std::pair(std::max(begin, first), std::min(begin + grid::kChunkSide, end));
            };
            const auto [left, right] = inside(corner.i, box.i_begin, box.i_end);
            const auto [low, high] = inside(corner.j, box.j_begin, box.j_end);
            for (std::int32_t j = low; j < high; ++j) {
                for (std::int32_t i = left; i < right; ++i) cells_[index_of({i, j})] = chunk.at({i, j});
            }
        });
    }

    [[nodiscard]] CellClass at(grid::Cell cell) const {
        const bool is_inside =
            cell.i >= box_.i_begin && cell.i < box_.i_end && cell.j >= box_.j_begin && cell.j < box_.j_end;
        return is_inside ? cells_[index_of(cell)] : CellClass::kUnexplored;
    }

    [[nodiscard]] bool is_free(grid::Cell cell) const {
        return at(cell) == CellClass::kFree || at(cell) == CellClass::kDanger;
    }

    /// Returns whether all cells of a square are free.
    /// @param reach  cells from the middle to the sides
    [[nodiscard]] bool is_free_around(grid::Cell middle, std::int32_t reach) const {
        for (std::int32_t j = middle.j - reach; j <= middle.j + reach; ++j) {
            for (std::int32_t i = middle.i - reach; i <= middle.i + reach; ++i) {
                if (!is_free({i, j})) return false;
            }
        }
        return true;
    }

private:
    [[nodiscard]] std::size_t index_of(grid::Cell cell) const {
        return static_cast<std::size_t>((cell.j - box_.j_begin) * box_.width() + (cell.i - box_.i_begin));
    }

    grid::CellBox box_;
    std::vector<CellClass> cells_; // by rows
};

/// Returns the cell of a square that is nearest to its middle and has room around it.
std::optional<grid::Cell> place_in(const Cells& cells, grid::Cell first, std::int32_t side, std::int32_t clearance) {
    std::optional<grid::Cell> best;
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    for (std::int32_t j = first.j; j < first.j + side; ++j) {
        for (std::int32_t i = first.i; i < first.i + side; ++i) {
            const std::int32_t x = 2 * (i - first.i) - side;
            const std::int32_t y = 2 * (j - first.j) - side;
            if (x * x + y * y >= least || !cells.is_free_around({i, j}, clearance)) continue;
            least = x * x + y * y;
            best = {i, j};
        }
    }
    return best;
}

/// Returns the distance to the first occupied cell, in cells; nullopt: the beam ends in unknown space or beyond
/// `reach`.
std::optional<double> distance_to_wall(const Cells& cells, const Point2& from, const SinCos& direction, double reach) {
    for (double distance = 0.0; distance < reach; distance += kStep) {
        const grid::Cell cell{static_cast<std::int32_t>(std::floor(from.x + distance * direction.cos)),
                              static_cast<std::int32_t>(std::floor(from.y + distance * direction.sin))};
        if (cells.at(cell) == CellClass::kOccupied) return distance; // a wall is somewhere in the cell
        if (!cells.is_free(cell)) return std::nullopt;
    }
    return std::nullopt;
}

/// Returns the scan of a laser at a place, in cells.
Scan scan_at(const Cells& cells, const Point2& place, double cell_size, const Sensor& laser) {
    Scan scan;
    scan.ranges.assign(kBeams, kNoReturn);
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
        const SinCos direction = scan_matching::sin_cos(beam_angle(laser.angles, beam));
        const auto distance = distance_to_wall(cells, place, direction, kReach / cell_size);
        if (distance) scan.ranges[beam] = to_range_mm(*distance * cell_size);
    }
    return scan;
}

/// Returns the rows and columns of the tiles that have known cells, in order. @param side  cells
std::set<std::pair<std::int32_t, std::int32_t>> tiles_of(const classify::ClassView& classes, std::int32_t side) {
    const auto tile_of = [&](std::int32_t cell) { return (cell >= 0 ? cell : cell - side + 1) / side; };
    std::set<std::pair<std::int32_t, std::int32_t>> tiles;
    classes.visit({}, 0, [&](grid::ChunkKey key, const classify::ClassChunk&) {
        const std::int32_t i = key.ci * grid::kChunkSide;
        const std::int32_t j = key.cj * grid::kChunkSide;
        for (std::int32_t row = tile_of(j); row <= tile_of(j + grid::kChunkSide - 1); ++row) {
            for (std::int32_t column = tile_of(i); column <= tile_of(i + grid::kChunkSide - 1); ++column) {
                tiles.emplace(row, column);
            }
        }
    });
    return tiles;
}

/// Returns the laser that takes the views.
Sensor laser_of_views() {
    Sensor laser;
    laser.angles = UniformAngles{-std::numbers::pi, 2.0 * std::numbers::pi / kBeams, kBeams};
    laser.range_max = kReach;
    return laser;
}

} // namespace

std::vector<slam::KnownView> views_of(const classify::ClassView& classes, double cell_size) {
    const auto side = std::max(1, static_cast<std::int32_t>(kSpacing / cell_size));
    const auto clearance = static_cast<std::int32_t>(std::ceil(kClearance / cell_size));
    const auto reach = static_cast<std::int32_t>(std::ceil(kReach / cell_size));
    const Sensor laser = laser_of_views();
    std::vector<slam::KnownView> views;
    for (const auto& [row, column] : tiles_of(classes, side * kSquaresOfTile)) {
        const grid::Cell corner{column * side * kSquaresOfTile, row * side * kSquaresOfTile};
        const grid::Cell end{corner.i + side * kSquaresOfTile, corner.j + side * kSquaresOfTile};
        const Cells cells(classes, {corner.i - reach, corner.j - reach, end.i + reach, end.j + reach});
        for (grid::Cell square = corner; square.j < end.j; square.j += side) {
            for (square.i = corner.i; square.i < end.i; square.i += side) {
                const auto place = place_in(cells, square, side, clearance);
                if (!place) continue;
                const Point2 middle{place->i + 0.5, place->j + 0.5};
                auto points = scan_matching::points_of(scan_at(cells, middle, cell_size, laser), laser);
                if (points.points.size() < kHitsMin) continue;
                views.push_back({{middle.x * cell_size, middle.y * cell_size, {}}, std::move(points)});
            }
        }
    }
    return views;
}

} // namespace scanloom::localization
