#include "sim/drive/ground.hpp"

#include "core/planning/grid_path.hpp"
#include "core/planning/line_of_sight.hpp"
#include "sim/drive/behaviour.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scanloom::sim {
namespace {

/// Returns the cells whose centres are nearer than `clearance_m` to the square of one of `cells`.
BitGrid cells_near(const BitGrid& cells, double clearance_m, double cell_size) {
    const double radius = clearance_m / cell_size - 2.0 * planning::kRoundingCells; // at the clearance the body fits
    return radius > 0.0 ? planning::dilated(cells, planning::disc_half_widths(radius, true)) : cells;
}

/// Returns a grid of clear bits, whole blocks of a CostSearch.
BitGrid blank_over(const grid::CellBox& cells) {
    const auto whole = [](std::int64_t count) { return static_cast<std::int32_t>((count + 63) / 64 * 64); };
    return {whole(cells.width()), whole(cells.height())};
}

} // namespace

FloorPlan::FloorPlan(double cell_size_m, const grid::CellBox& cells)
    : cell_size(cell_size_m), window(cells), free(blank_over(cells)) {}

Ground::Ground(const FloorPlan& plan, double clearance_m) {
    planning::Passability& p = passability_;
    p = {.window = plan.window, .cell_size_m = plan.cell_size, .options = {}, .ground = plan.free};
    p.options.body_radius_m = clearance_m - 2.0 * planning::kRoundingCells * plan.cell_size;
    p.occupied = p.danger = blank_over(plan.window);
    for (std::int32_t y = 0; y < plan.window.height(); ++y) {
        for (std::int32_t x = 0; x < plan.window.width(); ++x) {
            if (!p.ground.test({x, y})) p.occupied.set({x, y});
        }
    }
    p.obstacles = p.occupied;
    p.enterable = p.ground;
    p.enterable.subtract(cells_near(p.obstacles, clearance_m, plan.cell_size));
    p.fits = p.enterable;
}

Ground Ground::without(std::span<const Point2> obstacles, double clearance_m) const {
    BitGrid added(free().width(), free().height());
    for (const Point2& obstacle : obstacles) {
        if (const Spot spot = spot_of(obstacle); holds(spot)) added.set(spot);
    }
    Ground less = *this;
    less.passability_.occupied |= added;
    less.passability_.obstacles |= added;
    less.passability_.enterable.subtract(cells_near(added, clearance_m, cell_size()));
    less.passability_.options.body_radius_m = std::min(passability_.options.body_radius_m, clearance_m);
    return less;
}

Spot Ground::spot_of(const Point2& point) const noexcept {
    const double per_metre = 1.0 / cell_size();
    return {static_cast<std::int32_t>(std::floor(point.x * per_metre)) - passability_.window.i_begin,
            static_cast<std::int32_t>(std::floor(point.y * per_metre)) - passability_.window.j_begin};
}

bool Ground::fits_along(const Point2& from, const Point2& to) const {
    const Spot first = spot_of(from);
    const Spot last = spot_of(to);
    return fits(first) && fits(last) &&
           planning::cost_of_line(passability_, planning::to_cells(passability_, from, first),
                                  planning::to_cells(passability_, to, last));
}

bool Ground::is_near_solid(const Point2& point, double metres) const noexcept {
    const Spot centre = spot_of(point);
    const auto reach = static_cast<std::int32_t>(std::ceil(metres / cell_size()));
    for (std::int32_t dy = -reach; dy <= reach; ++dy) {
        for (std::int32_t dx = -reach; dx <= reach; ++dx) {
            if (!is_free({centre.x + dx, centre.y + dy})) return true;
        }
    }
    return false;
}

std::optional<std::vector<Point2>> find_path(const Ground& ground, const Point2& from, const Point2& to) {
    if (ground.fits_along(from, to)) return std::vector{from, to};
    planning::Passability passability = ground.passability();
    const auto start = planning::open_start(passability, from);
    const Spot goal = ground.spot_of(to);
    if (!start || !ground.fits(goal) || !planning::connected(passability.enterable, *start).test(goal)) {
        return std::nullopt;
    }
    planning::CostSearch search(passability);
    search.between(*start, goal);
    return planning::to_path(passability, search.path_to(goal), from, to, planning::Shape::kStraightened).points;
}

std::optional<std::size_t> nearest_by_path(const Ground& ground, const Point2& from, std::span<const Point2> targets) {
    planning::Passability passability = ground.passability();
    const auto start = planning::open_start(passability, from);
    if (!start) return std::nullopt;
    BitGrid wanted(ground.free().width(), ground.free().height());
    for (const Point2& target : targets) {
        if (ground.fits(ground.spot_of(target))) wanted.set(ground.spot_of(target));
    }
    const auto found = planning::CostSearch(passability).nearest(*start, wanted);
    if (!found) return std::nullopt;
    const auto is_there = [&](const Point2& target) { return ground.spot_of(target) == *found; };
    return static_cast<std::size_t>(std::ranges::find_if(targets, is_there) - targets.begin());
}

BitGrid reachable_from(const Ground& ground, const Point2& point) {
    planning::Passability passability = ground.passability();
    const auto start = planning::open_start(passability, point);
    if (!start) return {ground.free().width(), ground.free().height()};
    BitGrid reachable = planning::connected(passability.enterable, *start);
    reachable &= ground.passability().enterable;
    return reachable;
}

CoverageMeter::CoverageMeter(const Ground& ground, const BitGrid& places)
    : left_(planning::dilated(places, planning::disc_half_widths(kBodyRadius / ground.cell_size(), false))),
      cell_m2_(ground.cell_size() * ground.cell_size()) {
    left_ &= ground.free();
    reachable_ = left_.count();
}

void CoverageMeter::pass(const Ground& ground, const Point2& position) {
    const Spot centre = ground.spot_of(position);
    const auto reach = static_cast<std::int32_t>(std::ceil(kBodyRadius / ground.cell_size()));
    for (std::int32_t y = centre.y - reach; y <= centre.y + reach; ++y) {
        for (std::int32_t x = centre.x - reach; x <= centre.x + reach; ++x) {
            if (!ground.is_free({x, y}) || !left_.test({x, y})) continue;
            if (norm(ground.centre_of({x, y}) - position) > kBodyRadius) continue;
            left_.clear({x, y});
            ++passed_;
        }
    }
}

double CoverageMeter::share() const noexcept {
    return reachable_ == 0 ? 1.0 : static_cast<double>(passed_) / static_cast<double>(reachable_);
}

} // namespace scanloom::sim
