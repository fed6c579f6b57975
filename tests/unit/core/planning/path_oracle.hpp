#pragma once

#include "core/planning/passability.hpp"
#include "tests/support/class_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

/// Slow and simple versions of the planning contracts, written directly from the headers.
namespace scanloom::testing_support {

using planning::PassabilityOptions;

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The cells of a box and the subset that a body may enter.
class Oracle {
public:
    Oracle(const ClassView& view, const grid::CellBox& box, double cell_size_m, const PassabilityOptions& options)
        : view_(view), box_(box), options_(options), radius_(options.body_radius_m / cell_size_m + 1e-9),
          radius_of_centres_(radius_) {
        // A diagonal step between two centres may be nearer to a square than both centres. In that case the radius for
        // centres is increased.
        for (int offset = 1; offset < radius_; ++offset) {
            const double of_centres = std::hypot(offset + 0.5, offset - 0.5);
            if (offset * std::sqrt(2.0) <= radius_ && of_centres > radius_) radius_of_centres_ = of_centres + 1e-9;
        }
        find_touched();
        for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
            for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
                if (is_obstacle({i, j})) obstacles_.push_back({i, j});
                if (may_be_entered({i, j})) enterable_.insert({j, i});
            }
        }
    }

    [[nodiscard]] bool enterable(Cell cell) const { return enterable_.contains({cell.j, cell.i}); }
    [[nodiscard]] double factor(Cell cell) const {
        return class_at(view_, cell) == CellClass::kDanger ? 1.0 + options_.danger_cost : 1.0;
    }

    /// Returns the cost from `start` to every reachable cell, in cells, by (j, i).
    [[nodiscard]] std::map<std::pair<int, int>, double> costs(Cell start) const {
        std::map<std::pair<int, int>, double> visited;
        std::set<std::tuple<double, int, int>> open = {{0.0, start.j, start.i}};
        while (!open.empty()) {
            const auto [cost, j, i] = *open.begin();
            open.erase(open.begin());
            if (!visited.try_emplace({j, i}, cost).second) continue;
            for (int dj = -1; dj <= 1; ++dj) {
                for (int di = -1; di <= 1; ++di) {
                    const Cell next{i + di, j + dj};
                    const bool cuts_a_corner = !enterable({next.i, j}) || !enterable({i, next.j});
                    if (!enterable(next) || cuts_a_corner) continue;
                    open.insert({cost + std::hypot(di, dj) * (factor({i, j}) + factor(next)) / 2.0, next.j, next.i});
                }
            }
        }
        return visited;
    }

    /// Returns whether a body on a straight line between two points keeps its radius minus `slack` from the squares of
    /// all obstacles. Unit: cells.
    [[nodiscard]] bool keeps_clear(const Point2& from, const Point2& to, double slack = 0.0) const {
        return is_inside(from, to, slack) && std::ranges::all_of(obstacles_, [&](Cell cell) {
                   return distance(from, to, low_corner(cell)) > radius_ - slack;
               });
    }

    /// Returns the cost of a straight line in cells, or nullopt if it touches the square of a closed cell.
    [[nodiscard]] std::optional<double> cost_of_line(const Point2& from, const Point2& to) const {
        double cost = 0.0;
        const Point2 low = min_corner(from, to);
        const Point2 high = max_corner(from, to);
        for (auto j = static_cast<int>(std::floor(low.y)) - 1; j <= high.y; ++j) {
            for (auto i = static_cast<int>(std::floor(low.x)) - 1; i <= high.x; ++i) {
                const double part = part_inside(from, to, {i, j});
                if (part < 0.0) continue;
                if (!enterable({i, j})) return std::nullopt;
                cost += part * norm(to - from) * factor({i, j});
            }
        }
        return cost;
    }

private:
    [[nodiscard]] static Point2 low_corner(Cell cell) {
        return {static_cast<double>(cell.i), static_cast<double>(cell.j)};
    }

    [[nodiscard]] bool is_obstacle(Cell cell) const {
        if (cell.i < box_.i_begin || cell.i >= box_.i_end || cell.j < box_.j_begin || cell.j >= box_.j_end)
            return false;
        const auto value = class_at(view_, cell);
        const bool unknown = value == CellClass::kUnexplored || value == CellClass::kFrontier;
        return value == CellClass::kOccupied || (unknown && options_.on_known && !options_.allow_unknown);
    }

    /// Returns whether the body stays inside the box, if that is required: all cells outside the box are unknown.
    [[nodiscard]] bool is_inside(const Point2& from, const Point2& to, double slack) const {
        if (!options_.on_known || options_.body_radius_m == 0.0) return true;
        const Point2 low = min_corner(from, to) - Point2{radius_, radius_} + Point2{slack, slack};
        const Point2 high = max_corner(from, to) + Point2{radius_, radius_} - Point2{slack, slack};
        return low.x > box_.i_begin && low.y > box_.j_begin && high.x < box_.i_end && high.y < box_.j_end;
    }

    [[nodiscard]] bool may_be_entered(Cell cell) const {
        const Point2 centre{cell.i + 0.5, cell.j + 0.5};
        const auto value = class_at(view_, cell);
        if (value == CellClass::kOccupied) return false;
        const bool unknown = value == CellClass::kUnexplored || value == CellClass::kFrontier;
        if (unknown && !options_.allow_unknown) return false;
        return is_inside(centre, centre, radius_ - radius_of_centres_) &&
               std::ranges::none_of(touched_, [&](Cell offset) {
                   return is_obstacle({cell.i + offset.i, cell.j + offset.j});
               });
    }

    /// Finds the cells that a body in the centre of cell (0, 0) touches.
    void find_touched() {
        const auto reach = static_cast<std::int32_t>(radius_of_centres_) + 1;
        for (std::int32_t j = -reach; j <= reach; ++j) {
            for (std::int32_t i = -reach; i <= reach; ++i) {
                const double dx = std::max(std::abs(i) - 0.5, 0.0);
                const double dy = std::max(std::abs(j) - 0.5, 0.0);
                if (std::hypot(dx, dy) <= radius_of_centres_) touched_.push_back({i, j});
            }
        }
    }

    /// Returns the distance from a line to a cell's square. Along the line, the distance to the square falls and then
    /// rises.
    [[nodiscard]] static double distance(const Point2& from, const Point2& to, const Point2& low) {
        const auto at = [&](double part) {
            const Point2 point = from + part * (to - from);
            const Point2 nearest = min_corner(max_corner(point, low), low + Point2{1.0, 1.0});
            return norm(point - nearest);
        };
        double begin = 0.0;
        double end = 1.0;
        for (int halving = 0; halving < 100; ++halving) {
            const double third = (end - begin) / 3.0;
            (at(begin + third) <= at(end - third) ? end : begin) =
                at(begin + third) <= at(end - third) ? end - third : begin + third;
        }
        return at(begin);
    }

    /// Returns the fraction of the line inside a cell's square, 0 .. 1, or a negative number if the line does not touch
    /// it.
    /// Source  Liang, Barsky, A New Concept and Method for Line Clipping (1984).
    [[nodiscard]] static double part_inside(const Point2& from, const Point2& to, Cell cell) {
        constexpr double kTouch = 1e-10;
        double begin = 0.0;
        double end = 1.0;
        const Point2 low = low_corner(cell);
        for (const auto axis : {&Point2::x, &Point2::y}) {
            const double delta = to.*axis - from.*axis;
            if (delta == 0.0) {
                if (from.*axis < low.*axis || from.*axis > low.*axis + 1.0) return -1.0;
                continue;
            }
            const double a = (low.*axis - from.*axis) / delta;
            const double b = (low.*axis + 1.0 - from.*axis) / delta;
            begin = std::max(begin, std::min(a, b));
            end = std::min(end, std::max(a, b));
        }
        return end >= begin ? end - begin : end >= begin - kTouch ? 0.0 : -1.0;
    }

    const ClassView& view_;
    grid::CellBox box_;
    PassabilityOptions options_;
    double radius_; // cells
    double radius_of_centres_;
    std::vector<Cell> touched_; // by a body, relative to the cell of its centre
    std::vector<Cell> obstacles_;
    std::set<std::pair<int, int>> enterable_;
};

} // namespace scanloom::testing_support
