#include "server/landmarks/cell_index.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace scanloom::landmarks {
namespace {

/// Side of a square as a fraction of the radius. 1 / sqrt(2) would do; this leaves a hundredth for rounding.
constexpr double kSide = 0.7;

struct Place {
    std::int64_t j;
    std::int64_t i;
    std::uint32_t index;

    [[nodiscard]] bool operator<(const Place& other) const {
        return std::tie(j, i, index) < std::tie(other.j, other.i, other.index);
    }
};

} // namespace

CellIndex CellIndex::of_radius(std::span<const Point2> points, double radius) { return {points, kSide * radius}; }

CellIndex::CellIndex(std::span<const Point2> points, double side) : order_(points.size()) {
    const double per_metre = 1.0 / side;
    const auto cell_of = [&](double metres) { return static_cast<std::int64_t>(std::floor(metres * per_metre)); };
    std::vector<Place> places(points.size());
    for (std::uint32_t n = 0; n < places.size(); ++n) places[n] = {cell_of(points[n].y), cell_of(points[n].x), n};
    std::sort(places.begin(), places.end());
    for (std::uint32_t n = 0; n < places.size(); ++n) {
        const Place& place = places[n];
        order_[n] = place.index;
        if (n == 0 || place.j != cells_.back().j || place.i != cells_.back().i) {
            cells_.push_back({place.j, place.i, n, n});
        }
        cells_.back().end = n + 1;
    }
}

std::size_t CellIndex::first_from(std::int64_t j, std::int64_t i) const {
    const auto comes_before = [](const Cell& cell, const std::pair<std::int64_t, std::int64_t>& at) {
        return std::tie(cell.j, cell.i) < std::tie(at.first, at.second);
    };
    const auto found = std::lower_bound(cells_.begin(), cells_.end(), std::pair(j, i), comes_before);
    return static_cast<std::size_t>(found - cells_.begin());
}

} // namespace scanloom::landmarks
