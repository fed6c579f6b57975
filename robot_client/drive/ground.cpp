#include "robot_client/drive/ground.hpp"

#include <algorithm>
#include <cmath>
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

} // namespace scanloom::robot
