#include "core/planning/grid_path.hpp"

#include "core/planning/line_of_sight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>

namespace scanloom::planning {
namespace {

/// Relative tolerance: a different order of summation must not keep a corner.
constexpr double kRounding = 1e-12;

Point2 centre_of(Spot spot) { return {spot.x + 0.5, spot.y + 0.5}; }

bool straight_on(const Point2& a, const Point2& b, const Point2& c) {
    const Point2 ab = b - a;
    const Point2 bc = c - b;
    return ab.x * bc.y - ab.y * bc.x == 0.0 && dot(ab, bc) >= 0.0;
}

/// Returns the centres of the cells between the two points, without those on a straight line between their neighbours.
std::vector<Point2> corners(const std::vector<Spot>& cells, const Point2& start, const Point2& goal) {
    std::vector<Point2> points = {start};
    const auto append = [&](const Point2& point) {
        if (point == points.back()) return;
        if (points.size() > 1 && straight_on(points[points.size() - 2], points.back(), point)) points.pop_back();
        points.push_back(point);
    };
    for (const Spot cell : cells) append(centre_of(cell));
    append(goal);
    return points;
}

/// Returns the cost from one corner to the next. It exists, because both are in one cell or in two adjacent cells that
/// can be entered.
double cost_of_step(const Passability& passability, const Point2& from, const Point2& to) {
    const auto cost = cost_of_line(passability, from, to);
    assert(cost);
    return *cost;
}

/// Removes the corners of a path wherever a straight segment is as safe and costs no more.
class Straightener {
public:
    Straightener(const Passability& passability, const std::vector<Point2>& points)
        : passability_(passability), points_(points), costs_{0.0} {
        for (std::size_t at = 0; at + 1 < points.size(); ++at) {
            costs_.push_back(costs_.back() + cost_of_step(passability, points[at], points[at + 1]));
        }
    }

    [[nodiscard]] std::vector<Point2> straightened() const {
        std::vector<Point2> kept = {points_.front()};
        for (std::size_t at = 0; at + 1 < points_.size();) {
            at = furthest_from(at);
            kept.push_back(points_[at]);
        }
        return kept;
    }

private:
    /// Returns the furthest corner that a straight segment can reach: halves the distance from the end until a segment
    /// works, then extends it as long as it is no worse.
    [[nodiscard]] std::size_t furthest_from(std::size_t at) const {
        std::size_t furthest = at + 1;
        double cost = costs_[furthest] - costs_[at];
        for (std::size_t ahead = points_.size() - 1 - at; ahead > 1; ahead /= 2) {
            const auto straight = straight_cost(at, at + ahead, costs_[at + ahead] - costs_[at]);
            if (!straight) continue;
            furthest = at + ahead;
            cost = *straight;
            break;
        }
        while (furthest + 1 < points_.size()) {
            const auto straight = straight_cost(at, furthest + 1, cost + costs_[furthest + 1] - costs_[furthest]);
            if (!straight) break;
            ++furthest;
            cost = *straight;
        }
        return furthest;
    }

    /// Returns the cost of the straight segment, or nullopt if it is less safe or costs more than `around`.
    [[nodiscard]] std::optional<double> straight_cost(std::size_t from, std::size_t to, double around) const {
        const auto straight = cost_of_line(passability_, points_[from], points_[to]);
        if (!straight || *straight > around * (1.0 + kRounding)) return std::nullopt;
        return keeps_clear(passability_, points_[from], points_[to]) ? straight : std::nullopt;
    }

    const Passability& passability_;
    const std::vector<Point2>& points_;
    std::vector<double> costs_; // cost from the first point to each point
};

Path within_a_cell(const Passability& passability, Spot cell, const Point2& start, const Point2& goal) {
    const double length = norm(goal - start);
    const double factor = passability.danger.test(cell) ? 1.0 + passability.options.danger_cost : 1.0;
    return {{start, goal}, length, length * factor};
}

} // namespace

Path to_path(const Passability& passability, const std::vector<Spot>& cells, const Point2& start, const Point2& goal,
             Shape shape) {
    if (cells.size() == 1) return within_a_cell(passability, cells.front(), start, goal);
    auto points =
        corners(cells, to_cells(passability, start, cells.front()), to_cells(passability, goal, cells.back()));
    if (shape == Shape::kStraightened) points = Straightener(passability, points).straightened();
    Path path;
    for (std::size_t at = 0; at + 1 < points.size(); ++at) {
        path.length_m += norm(points[at + 1] - points[at]) * passability.cell_size_m;
        path.cost += cost_of_step(passability, points[at], points[at + 1]) * passability.cell_size_m;
    }
    const Point2 corner{static_cast<double>(passability.window.i_begin),
                        static_cast<double>(passability.window.j_begin)};
    for (const Point2& point : points) path.points.push_back((point + corner) * passability.cell_size_m);
    path.points.front() = start; // bit-identical
    path.points.back() = goal;
    return path;
}

Result<Path> plan_path(const classify::ClassView& classes, double cell_size_m, const Point2& start, const Point2& goal,
                       const PassabilityOptions& options, Shape shape) {
    const std::array ends = {start, goal};
    auto passability = make_passability(classes, cell_size_m, options, ends);
    if (!passability) return passability.error();
    const auto first = open_start(*passability, start);
    if (!first) return first.error();
    const auto last = check_goal(*passability, goal);
    if (!last) return last.error();
    if (!connected(passability->enterable, *first).test(*last)) {
        return Error{Errc::kNoPath,
                     fmt::format("there is no path from ({:g}, {:g}) to ({:g}, {:g}) for a body of radius {} m",
                                 start.x, start.y, goal.x, goal.y, options.body_radius_m)};
    }
    CostSearch search(*passability);
    search.between(*first, *last);
    return to_path(*passability, search.path_to(*last), start, goal, shape);
}

} // namespace scanloom::planning
