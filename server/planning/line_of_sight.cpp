#include "server/planning/line_of_sight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::planning {
namespace {

/// In cells: a line that passes a corner at a smaller distance counts as going through it.
constexpr double kCorner = 1e-9;

/// How a line crosses the cells along one axis. Positions are fractions of the line's length, 0 .. 1.
struct Axis {
    std::int32_t step;   // -1, 0, 1
    double to_next_cell; // where the line leaves the current cell
    double across_cell;  // between two such places

    Axis(double from, double to) {
        const double delta = to - from;
        step = delta > 0.0 ? 1 : delta < 0.0 ? -1 : 0;
        across_cell = step == 0 ? std::numeric_limits<double>::infinity() : 1.0 / std::abs(delta);
        const double left = step > 0 ? std::floor(from) + 1.0 - from : from - std::floor(from);
        to_next_cell = step == 0 ? std::numeric_limits<double>::infinity() : left * across_cell;
    }

    void advance(std::int32_t& cell) {
        cell += step;
        to_next_cell += across_cell;
    }
};

bool is_border(double a, double b) { return a == b && a == std::floor(a); }

/// Returns the cost of a line along the border between two rows or columns of cells. It touches both, so the more
/// expensive one counts.
std::optional<double> cost_beside(const Passability& passability, const Point2& from, const Point2& to,
                                  const Point2& aside) {
    const auto one = cost_of_line(passability, from + aside, to + aside);
    const auto other = cost_of_line(passability, from - aside, to - aside);
    if (!one || !other) return std::nullopt;
    return std::max(*one, *other);
}

} // namespace

std::optional<double> cost_of_line(const Passability& passability, const Point2& from, const Point2& to) {
    const double length = norm(to - from);
    if (length == 0.0) return 0.0;
    if (is_border(from.x, to.x)) return cost_beside(passability, from, to, {0.5, 0.0});
    if (is_border(from.y, to.y)) return cost_beside(passability, from, to, {0.0, 0.5});
    const BitGrid& enterable = passability.enterable;
    Axis x(from.x, to.x);
    Axis y(from.y, to.y);
    Spot at{static_cast<std::int32_t>(std::floor(from.x)), static_cast<std::int32_t>(std::floor(from.y))};
    double in_danger = 0.0;
    for (double entered = 0.0;;) {
        if (!enterable.test(at)) return std::nullopt;
        const double left = std::min({x.to_next_cell, y.to_next_cell, 1.0});
        if (passability.danger.test(at)) in_danger += left - entered;
        if (left == 1.0) break;
        entered = left;
        const double corner = (x.to_next_cell - y.to_next_cell) * length;
        if (std::abs(corner) < kCorner) {
            if (!enterable.test({at.x + x.step, at.y}) || !enterable.test({at.x, at.y + y.step})) return std::nullopt;
            x.advance(at.x);
            y.advance(at.y);
        } else if (corner < 0.0) {
            x.advance(at.x);
        } else {
            y.advance(at.y);
        }
    }
    return length * (1.0 + in_danger * passability.options.danger_cost);
}

} // namespace scanloom::planning
