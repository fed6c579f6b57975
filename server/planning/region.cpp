#include "server/planning/region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::planning {
namespace {

Result<> check(std::span<const Point2> corners) {
    if (corners.size() < 3 || corners.size() > kRegionCornersMax) {
        return Error{Errc::kInvalidField,
                     fmt::format("region has {} corners; it must have 3 .. {}", corners.size(), kRegionCornersMax)};
    }
    for (std::size_t n = 0; n < corners.size(); ++n) {
        if (!is_finite(corners[n])) {
            return Error{Errc::kInvalidField, fmt::format("region[{}] is not a finite point", n)};
        }
    }
    return {};
}

/// Returns where the polygon's edges cross a horizontal line, from left to right.
std::vector<double> crossings(std::span<const Point2> corners, double y) {
    std::vector<double> places;
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Point2& a = corners[n];
        const Point2& b = corners[(n + 1) % corners.size()];
        if ((a.y <= y) == (b.y <= y)) continue;
        places.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::ranges::sort(places);
    return places;
}

} // namespace

Result<BitGrid> cells_inside(const Passability& passability, std::span<const Point2> corners) {
    if (auto valid = check(corners); !valid) return valid.error();
    BitGrid inside(passability.ground.width(), passability.ground.height());
    const double width = passability.ground.width();
    for (std::int32_t y = 0; y < inside.height(); ++y) {
        const auto places = crossings(corners, passability.centre_of({0, y}).y);
        for (std::size_t n = 0; n + 1 < places.size(); n += 2) {
            // The first column whose centre is not left of the edge.
            const auto column = [&](double x) {
                const double cells = std::ceil(x / passability.cell_size_m - passability.window.i_begin - 0.5);
                return static_cast<std::int32_t>(std::clamp(cells, 0.0, width));
            };
            for (std::int32_t x = column(places[n]); x < column(places[n + 1]); ++x) inside.set({x, y});
        }
    }
    return inside;
}

} // namespace scanloom::planning
