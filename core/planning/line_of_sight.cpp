#include "core/planning/line_of_sight.hpp"

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

namespace {

/// The area that a disc covers while its centre moves from a to b.
class Capsule {
public:
    Capsule(const Point2& a, const Point2& b, double radius) : a_(a), b_(b), radius_(radius) {
        const double length = norm(b - a);
        if (length == 0.0) return;
        const Point2 along = (b - a) / length;
        beside_ = along.y >= 0.0 ? Point2{along.y, -along.x} : Point2{-along.y, along.x};
        beside_ *= radius;
    }

    [[nodiscard]] double bottom() const { return std::min(a_.y, b_.y) - radius_; }
    [[nodiscard]] double top() const { return std::max(a_.y, b_.y) + radius_; }

    /// Returns how far the capsule reaches to the right between two heights. The capsule is convex, so it reaches
    /// further the nearer the height is to that of its rightmost point.
    /// Precondition: the capsule reaches between the two heights.
    [[nodiscard]] double right(double low, double high) const {
        const auto [lowest, highest] = std::minmax(a_.y, b_.y);
        const double rightmost = a_.x > b_.x ? a_.y : a_.x < b_.x ? b_.y : std::clamp(low, lowest, highest);
        return right_at(std::clamp(rightmost, std::max(low, bottom()), std::min(high, top())));
    }

private:
    [[nodiscard]] double right_at(double y) const {
        double right = std::max(right_of_disc(a_, y), right_of_disc(b_, y));
        const Point2 from = a_ + beside_;
        const Point2 to = b_ + beside_;
        if (from.y != to.y && y >= std::min(from.y, to.y) && y <= std::max(from.y, to.y)) {
            right = std::max(right, from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y));
        }
        return right;
    }

    [[nodiscard]] double right_of_disc(const Point2& centre, double y) const {
        const double dy = std::abs(y - centre.y);
        if (dy > radius_) return -std::numeric_limits<double>::infinity();
        return centre.x + std::sqrt(radius_ * radius_ - dy * dy);
    }

    Point2 a_;
    Point2 b_;
    double radius_;
    Point2 beside_ = {0.0, 0.0}; // from the centre to the straight part of the right border
};

Point2 mirrored(const Point2& point) { return {-point.x, point.y}; }

} // namespace

bool keeps_clear(const Passability& passability, const Point2& from, const Point2& to) {
    if (passability.options.body_radius_m == 0.0) return true; // a point touches nothing
    const BitGrid& obstacles = passability.obstacles;
    const double radius = passability.options.body_radius_m / passability.cell_size_m + kRoundingCells;
    const Capsule capsule(from, to, radius);
    const Capsule mirror(mirrored(from), mirrored(to), radius);
    const bool beyond = capsule.bottom() < 0.0 || capsule.top() > obstacles.height() ||
                        mirror.right(capsule.bottom(), capsule.top()) > 0.0 ||
                        capsule.right(capsule.bottom(), capsule.top()) > obstacles.width();
    if (beyond && passability.options.on_known) return false;
    const auto first = std::max(static_cast<std::int32_t>(std::floor(capsule.bottom())), 0);
    const auto last = std::min(static_cast<std::int32_t>(std::floor(capsule.top())), obstacles.height() - 1);
    for (std::int32_t y = first; y <= last; ++y) {
        const auto left = static_cast<std::int32_t>(std::floor(-mirror.right(y, y + 1.0)));
        const auto right = static_cast<std::int32_t>(std::floor(capsule.right(y, y + 1.0)));
        if (next_set(obstacles.row(y), std::max(left, 0)) <= std::min(right, obstacles.width() - 1)) return false;
    }
    return true;
}

} // namespace scanloom::planning
