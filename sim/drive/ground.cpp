#include "sim/drive/ground.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace scanloom::robot {
namespace {

/// Returns the distance in metres from a cell's centre to the square of the cell `dx` columns and `dy` rows away.
double to_square(std::int32_t dx, std::int32_t dy, double cell_size) {
    const double x = std::max(0.0, std::abs(dx) - 0.5);
    const double y = std::max(0.0, std::abs(dy) - 0.5);
    return cell_size * std::hypot(x, y);
}

constexpr double kRadiusTolerance = 1e-9; // metres

} // namespace

Ground::Ground(FloorPlan plan, double clearance_m) : plan_(std::move(plan)), fits_(plan_.is_free) {
    for (std::int32_t y = 0; y < plan_.height; ++y) {
        for (std::int32_t x = 0; x < plan_.width; ++x) {
            if (is_free({x, y})) continue;
            const bool is_at_rim =
                is_free({x - 1, y}) || is_free({x + 1, y}) || is_free({x, y - 1}) || is_free({x, y + 1});
            if (is_at_rim) take_out_around({x, y}, clearance_m);
        }
    }
}

Ground Ground::without(std::span<const Point2> obstacles, double clearance_m) const {
    Ground less = *this;
    for (const Point2& obstacle : obstacles) less.take_out_around(spot_of(obstacle), clearance_m);
    return less;
}

Spot Ground::spot_of(const Point2& point) const noexcept {
    const double per_metre = 1.0 / plan_.cell_size;
    return {static_cast<std::int32_t>(std::floor(point.x * per_metre)) - plan_.i_begin,
            static_cast<std::int32_t>(std::floor(point.y * per_metre)) - plan_.j_begin};
}

Point2 Ground::centre_of(Spot spot) const noexcept {
    return {(plan_.i_begin + spot.x + 0.5) * plan_.cell_size, (plan_.j_begin + spot.y + 0.5) * plan_.cell_size};
}

/// Checks points a quarter of a cell apart: a corner cut between two of them is cut by a small part of a cell.
bool Ground::fits_along(const Point2& from, const Point2& to) const noexcept {
    const int pieces = std::max(1, static_cast<int>(std::ceil(norm(to - from) / plan_.cell_size * 4.0)));
    for (int n = 0; n <= pieces; ++n) {
        const double part = static_cast<double>(n) / pieces;
        if (!fits(spot_of(from + part * (to - from)))) return false;
    }
    return true;
}

bool Ground::is_near_solid(const Point2& point, double metres) const noexcept {
    const Spot centre = spot_of(point);
    const auto reach = static_cast<std::int32_t>(std::ceil(metres / plan_.cell_size));
    for (std::int32_t dy = -reach; dy <= reach; ++dy) {
        for (std::int32_t dx = -reach; dx <= reach; ++dx) {
            if (!is_free({centre.x + dx, centre.y + dy})) return true;
        }
    }
    return false;
}

void Ground::take_out_around(Spot centre, double radius_m) {
    const auto reach = static_cast<std::int32_t>(std::ceil(radius_m / plan_.cell_size)) + 1;
    for (std::int32_t dy = -reach; dy <= reach; ++dy) {
        for (std::int32_t dx = -reach; dx <= reach; ++dx) {
            const Spot spot{centre.x + dx, centre.y + dy};
            if (!holds(spot) || to_square(dx, dy, plan_.cell_size) >= radius_m - kRadiusTolerance) continue;
            fits_[index_of(spot)] = 0;
        }
    }
}

namespace {

constexpr double kStartReach = 0.5; // metres

/// A search over the ground from one cell, ordered by cost plus an estimate of the remaining cost.
class Search {
public:
    Search(const Ground& ground, Spot start)
        : ground_(ground), cost_(ground.plan().is_free.size(), std::numeric_limits<float>::infinity()),
          came_from_(cost_.size()) {
        cost_[ground.index_of(start)] = 0.0F;
        came_from_[ground.index_of(start)] = start;
        open_.push({0.0F, start});
    }

    /// Continues until `is_wanted` accepts a cell, cheapest first.
    /// @return that cell
    template <class IsWanted, class Estimate>
    [[nodiscard]] std::optional<Spot> run(IsWanted&& is_wanted, Estimate&& estimate) {
        while (!open_.empty()) {
            const auto [bound, at] = open_.top();
            open_.pop();
            const float cost = cost_[ground_.index_of(at)];
            if (bound > cost + estimate(at)) continue; // a cheaper path to it was found
            if (is_wanted(at)) return at;
            expand(at, cost, estimate);
        }
        return std::nullopt;
    }

    [[nodiscard]] std::vector<Spot> path_to(Spot goal) const {
        std::vector<Spot> path = {goal};
        for (Spot before = came_from_[ground_.index_of(goal)]; before != path.back();
             before = came_from_[ground_.index_of(before)]) {
            path.push_back(before);
        }
        std::ranges::reverse(path);
        return path;
    }

private:
    struct Open {
        float bound;
        Spot spot;
        friend bool operator>(const Open& a, const Open& b) { // the same order on every machine
            return std::tuple(a.bound, a.spot.y, a.spot.x) > std::tuple(b.bound, b.spot.y, b.spot.x);
        }
    };

    template <class Estimate>
    void expand(Spot at, float cost, Estimate&& estimate) {
        for (std::int32_t dy = -1; dy <= 1; ++dy) {
            for (std::int32_t dx = -1; dx <= 1; ++dx) {
                const Spot next{at.x + dx, at.y + dy};
                if (!ground_.fits(next) || !ground_.fits({at.x + dx, at.y}) || !ground_.fits({at.x, at.y + dy}))
                    continue;
                const float step = dx != 0 && dy != 0 ? std::numbers::sqrt2_v<float> : 1.0F;
                float& known = cost_[ground_.index_of(next)];
                if (cost + step >= known) continue;
                known = cost + step;
                came_from_[ground_.index_of(next)] = at;
                open_.push({known + estimate(next), next});
            }
        }
    }

    const Ground& ground_;
    std::vector<float> cost_; // cells
    std::vector<Spot> came_from_;
    std::priority_queue<Open, std::vector<Open>, std::greater<>> open_;
};

std::vector<Point2> straightened(const Ground& ground, const std::vector<Point2>& points) {
    std::vector<Point2> kept = {points.front()};
    for (std::size_t at = 0; at + 1 < points.size();) {
        std::size_t next = at + 1;
        for (std::size_t step = points.size() - 1 - at; step > 0; step /= 2) { // approximately the farthest
            while (next + step < points.size() && ground.fits_along(points[at], points[next + step])) next += step;
        }
        kept.push_back(points[next]);
        at = next;
    }
    return kept;
}

} // namespace

std::optional<std::vector<Point2>> find_path(const Ground& ground, const Point2& from, const Point2& to) {
    if (ground.fits_along(from, to)) return std::vector{from, to};
    const Spot goal = ground.spot_of(to);
    const auto start = nearest_fitting(ground, from);
    if (!start || !ground.fits(goal)) return std::nullopt;
    const auto estimate = [&](Spot spot) {
        const auto [least, most] = std::minmax({std::abs(spot.x - goal.x), std::abs(spot.y - goal.y)});
        return static_cast<float>(most - least) + std::numbers::sqrt2_v<float> * static_cast<float>(least);
    };
    Search search(ground, *start);
    if (!search.run([&](Spot spot) { return spot == goal; }, estimate)) return std::nullopt;
    std::vector<Point2> points;
    for (const Spot spot : search.path_to(goal)) points.push_back(ground.centre_of(spot));
    points.back() = to;
    if (ground.fits(ground.spot_of(from))) {
        points.front() = from;
    } else {
        points.insert(points.begin(), from);
    }
    return straightened(ground, points);
}

std::optional<std::size_t> nearest_by_path(const Ground& ground, const Point2& from, std::span<const Point2> targets) {
    const auto start = nearest_fitting(ground, from);
    if (!start) return std::nullopt;
    const auto target_in = [&](Spot spot) {
        return std::ranges::find_if(targets, [&](const Point2& target) { return ground.spot_of(target) == spot; });
    };
    std::vector<std::uint8_t> is_wanted(ground.plan().is_free.size());
    for (const Point2& target : targets) {
        if (ground.fits(ground.spot_of(target))) is_wanted[ground.index_of(ground.spot_of(target))] = 1;
    }
    Search search(ground, *start);
    const auto found =
        search.run([&](Spot spot) { return is_wanted[ground.index_of(spot)] != 0; }, [](Spot) { return 0.0F; });
    if (!found) return std::nullopt;
    return static_cast<std::size_t>(target_in(*found) - targets.begin());
}

std::optional<Spot> nearest_fitting(const Ground& ground, const Point2& point) {
    const Spot centre = ground.spot_of(point);
    const auto reach = static_cast<std::int32_t>(kStartReach / ground.plan().cell_size);
    std::optional<Spot> nearest;
    double least = kStartReach;
    for (std::int32_t dy = -reach; dy <= reach; ++dy) {
        for (std::int32_t dx = -reach; dx <= reach; ++dx) {
            const Spot spot{centre.x + dx, centre.y + dy};
            if (!ground.fits(spot)) continue;
            const double distance = norm(ground.centre_of(spot) - point);
            if (distance >= least) continue;
            least = distance;
            nearest = spot;
        }
    }
    return nearest;
}

std::vector<std::uint8_t> reachable_from(const Ground& ground, const Point2& point) {
    std::vector<std::uint8_t> reached(ground.plan().is_free.size());
    const auto start = nearest_fitting(ground, point);
    if (!start) return reached;
    Search search(ground, *start);
    static_cast<void>(search.run(
        [&](Spot spot) {
            reached[ground.index_of(spot)] = 1;
            return false;
        },
        [](Spot) { return 0.0F; }));
    return reached;
}

} // namespace scanloom::robot
