#include "core/planning/coverage_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

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

namespace {

std::vector<SweepRow> rows_at(const BitGrid& ground, std::int32_t y) {
    std::vector<SweepRow> rows;
    const auto bits = ground.row(y);
    for (std::int32_t x = next_set(bits, 0); x < ground.width();) {
        const std::int32_t end = next_clear(bits, x);
        rows.push_back({y, x, end});
        x = next_set(bits, end);
    }
    return rows;
}

bool side_by_side(const SweepRow& a, const SweepRow& b) { return a.x_begin < b.x_end && b.x_begin < a.x_end; }

/// Returns the index of the only row that overlaps `row` in x, or nullopt if there is none or several.
std::optional<std::size_t> only_neighbour(const std::vector<SweepRow>& rows, const SweepRow& row) {
    std::optional<std::size_t> only;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        if (!side_by_side(rows[n], row)) continue;
        if (only) return std::nullopt;
        only = n;
    }
    return only;
}

std::optional<std::int32_t> lowest_row(const BitGrid& ground) {
    for (std::int32_t y = 0; y < ground.height(); ++y) {
        if (next_set(ground.row(y), 0) < ground.width()) return y;
    }
    return std::nullopt;
}

} // namespace

std::vector<SweepBlock> sweep_blocks(const BitGrid& ground, std::int32_t spacing) {
    std::vector<SweepBlock> blocks;
    std::vector<SweepRow> below;
    std::vector<std::size_t> blocks_below; // for each row below, the index of its block
    for (std::int32_t y = lowest_row(ground).value_or(ground.height()); y < ground.height(); y += spacing) {
        const auto rows = rows_at(ground, y);
        std::vector<std::size_t> blocks_here;
        for (const SweepRow& row : rows) {
            const auto under = only_neighbour(below, row);
            if (under && only_neighbour(rows, below[*under])) {
                blocks_here.push_back(blocks_below[*under]);
            } else {
                blocks_here.push_back(blocks.size());
                blocks.emplace_back();
            }
            blocks[blocks_here.back()].push_back(row);
        }
        below = rows;
        blocks_below = std::move(blocks_here);
    }
    return blocks;
}

} // namespace scanloom::planning
