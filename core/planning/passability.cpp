#include "core/planning/passability.hpp"

#include "common/scan/limits.hpp"
#include "core/classify/bit_plane.hpp"
#include "core/planning/line_of_sight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string_view>

namespace scanloom::planning {
namespace {

using classify::CellClass;
using classify::ClassChunk;
using classify::ClassView;

constexpr std::int32_t kSide = grid::kChunkSide;

Error invalid(std::string message) { return {Errc::kInvalidField, std::move(message)}; }

Result<> check(const PassabilityOptions& options) {
    if (!(options.body_radius_m >= 0.0 && options.body_radius_m <= kBodyRadiusMax)) {
        return invalid(fmt::format("body_radius is {} m; it must be 0 .. {}", options.body_radius_m, kBodyRadiusMax));
    }
    if (!(options.danger_cost >= 0.0 && options.danger_cost <= kDangerCostMax)) {
        return invalid(fmt::format("danger_cost is {}; it must be 0 .. {}", options.danger_cost, kDangerCostMax));
    }
    return {};
}

void read_chunk(Passability& passability, grid::ChunkKey key, const ClassChunk& chunk) {
    const auto word = static_cast<std::size_t>((key.ci * kSide - passability.window.i_begin) / kSide);
    const std::int32_t y0 = key.cj * kSide - passability.window.j_begin;
    for (std::int32_t j = 0; j < kSide; ++j) {
        const CellClass* cells = chunk.cells.data() + j * kSide;
        const std::uint64_t danger = classify::row_bits(cells, CellClass::kDanger);
        passability.occupied.row(y0 + j)[word] = classify::row_bits(cells, CellClass::kOccupied);
        passability.danger.row(y0 + j)[word] = danger;
        passability.ground.row(y0 + j)[word] = classify::row_bits(cells, CellClass::kFree) | danger;
    }
}

/// Returns the smallest radius, not below `radius`, such that a diagonal step between two cell centres keeps `radius`
/// if both centres keep the result. In cells.
///
/// The middle of the step is m sqrt(2) from the corner of the square m cells to its side; both centres are sqrt(2 m^2 +
/// 1/2) from that corner. No other square is nearer to the middle than to the centres.
double radius_for_steps(double radius) {
    const double offset = std::floor(std::numbers::sqrt2 / 2.0 * (radius + kRoundingCells));
    const double of_centres = std::sqrt(2.0 * offset * offset + 0.5);
    return offset >= 1.0 ? std::max(radius, of_centres) : radius;
}

void set_all(BitGrid& grid) {
    for (std::int32_t y = 0; y < grid.height(); ++y) std::ranges::fill(grid.row(y), ~std::uint64_t{0});
}

/// Clears the outermost `width` rows and columns.
void clear_border(BitGrid& grid, std::int32_t width) {
    const std::int32_t right = std::max(grid.width() - width, 0);
    for (std::int32_t y = 0; y < grid.height(); ++y) {
        if (y < width || y >= grid.height() - width) {
            std::ranges::fill(grid.row(y), std::uint64_t{0});
            continue;
        }
        for (std::int32_t x = 0; x < std::min(width, grid.width()); ++x) grid.clear({x, y});
        for (std::int32_t x = right; x < grid.width(); ++x) grid.clear({x, y});
    }
}

/// Returns the cell under a point where a path starts or ends; an error if a point cannot be there.
Result<Spot> ground_at(const Passability& passability, const Point2& point, std::string_view which) {
    const auto cell = numbered_cell(point, passability.cell_size_m);
    if (!cell) return prefixed(fmt::format("{}: ", which), cell.error());
    const auto refusal = [&](std::string_view why) {
        return Error{Errc::kNoPath, fmt::format("the {} ({:g}, {:g}) is {}", which, point.x, point.y, why)};
    };
    const auto spot = passability.spot_of(*cell);
    if (!spot && which == "start") return refusal("outside the map; it must be in explored free space");
    if (!spot) return refusal("outside the explored area around the start; it must be in free space there");
    if (passability.occupied.test(*spot)) return refusal("inside an obstacle; it must be in free space");
    if (!passability.ground.test(*spot)) {
        return refusal("in unknown space; it must be in free space, unless unknown cells are allowed");
    }
    return *spot;
}

BitGrid disc_around(const Passability& passability, Spot centre, double radius) {
    BitGrid disc(passability.ground.width(), passability.ground.height());
    disc.set(centre);
    return dilated(disc, disc_half_widths(radius, false));
}

/// Turns unknown cells that the body covers into ground if the body is next to known ground: a sensor that looks ahead
/// does not see its own cell.
void take_as_ground(Passability& passability, Spot place, double radius) {
    if (passability.ground.test(place) || passability.occupied.test(place)) return;
    BitGrid covered = disc_around(passability, place, radius);
    BitGrid known = covered;
    known &= passability.ground;
    if (known.count() == 0) return;
    covered.subtract(passability.occupied);
    passability.ground |= covered;
    if (passability.options.on_known) passability.obstacles.subtract(covered);
}

/// Returns the distance from a cell's centre to the nearest occupied square, at most `far`. In cells.
double clearance_of(const Passability& passability, Spot place, double far) {
    const auto reach = static_cast<std::int32_t>(far) + 1;
    double least = far;
    for (std::int32_t y = std::max(place.y - reach, 0);
         y <= std::min(place.y + reach, passability.occupied.height() - 1); ++y) {
        const auto row = passability.occupied.row(y);
        for (std::int32_t x = next_set(row, std::max(place.x - reach, 0));
             x <= std::min(place.x + reach, passability.occupied.width() - 1); x = next_set(row, x + 1)) {
            const double dx = std::max(std::abs(x - place.x) - 0.5, 0.0);
            const double dy = std::max(std::abs(y - place.y) - 0.5, 0.0);
            least = std::min(least, std::hypot(dx, dy));
        }
    }
    return least;
}

/// Returns the cells through which a body can leave a position where it should not be. These are the ground cells that
/// it covers. With on_known they also include cells that are not near occupied ones, as far as necessary to get to
/// known ground, but at most four times as far.
BitGrid exit_cells(const Passability& passability, Spot place, double radius) {
    BitGrid near = disc_around(passability, place, radius + 1.0);
    near &= passability.ground;
    const double clearance = clearance_of(passability, place, radius + 1.0) - kRoundingCells;
    if (clearance > kRoundingCells) {
        near.subtract(dilated(passability.occupied, disc_half_widths(clearance - 2.0 * kRoundingCells, true)));
    }
    near = connected(near, place);
    if (!passability.options.on_known) return near;
    BitGrid clear = passability.ground;
    clear.subtract(dilated(passability.occupied, disc_half_widths(radius_for_steps(radius), true)));
    for (const double times : {1.0, 1.5, 2.0, 3.0, 4.0}) {
        BitGrid cells = disc_around(passability, place, times * (radius + 1.0));
        cells &= clear;
        cells |= near;
        cells = connected(cells, place);
        BitGrid arrived = cells;
        arrived &= passability.enterable;
        if (arrived.count() > 0) return cells;
    }
    return near;
}

} // namespace

std::optional<Spot> Passability::spot_of(grid::Cell cell) const noexcept {
    if (cell.i < window.i_begin || cell.i >= window.i_end || cell.j < window.j_begin || cell.j >= window.j_end) {
        return std::nullopt;
    }
    return Spot{cell.i - window.i_begin, cell.j - window.j_begin};
}

std::optional<Spot> Passability::spot_at(const Point2& point) const noexcept {
    const double cells_per_metre = 1.0 / cell_size_m;
    const double x = std::floor(point.x * cells_per_metre) - window.i_begin;
    const double y = std::floor(point.y * cells_per_metre) - window.j_begin;
    if (!(x >= 0.0 && x < ground.width() && y >= 0.0 && y < ground.height())) return std::nullopt;
    return Spot{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
}

Point2 to_cells(const Passability& passability, const Point2& point, Spot cell) {
    const auto within = [](double x, std::int32_t lowest) {
        return std::clamp(x, static_cast<double>(lowest), std::nextafter(lowest + 1.0, 0.0));
    };
    const Point2 scaled = point * (1.0 / passability.cell_size_m);
    return {within(scaled.x - passability.window.i_begin, cell.x),
            within(scaled.y - passability.window.j_begin, cell.y)};
}

Result<Passability> make_passability(const ClassView& classes, double cell_size_m, const PassabilityOptions& options,
                                     std::span<const Point2> ends) {
    assert(cell_size_m > 0.0);
    if (auto valid = check(options); !valid) return valid.error();
    const auto window = search_window(classes, cell_size_m, {options.body_radius_m, options.allow_unknown}, ends);
    if (!window) return window.error();
    const grid::CellBox& box = window->box;
    const BitGrid blank(static_cast<std::int32_t>(box.width()), static_cast<std::int32_t>(box.height()));
    Passability passability{box, cell_size_m, options, blank, blank, blank, blank, blank, blank};
    classes.visit(grid::chunks_of(box), 0,
                  [&](grid::ChunkKey key, const ClassChunk& chunk) { read_chunk(passability, key, chunk); });
    if (options.allow_unknown) {
        set_all(passability.ground);
        passability.ground.subtract(passability.occupied);
    }
    passability.enterable = passability.ground;
    passability.obstacles = passability.occupied;
    const double radius = radius_for_steps(options.body_radius_m / cell_size_m);
    if (options.on_known) {
        set_all(passability.obstacles);
        passability.obstacles.subtract(passability.ground);
        clear_border(passability.enterable, static_cast<std::int32_t>(radius + kRoundingCells + 0.5));
    }
    passability.enterable.subtract(dilated(passability.obstacles, disc_half_widths(radius, true)));
    passability.fits = passability.enterable;
    return passability;
}

Result<Spot> open_start(Passability& passability, const Point2& start) {
    const double radius = passability.options.body_radius_m / passability.cell_size_m;
    if (const auto spot = passability.spot_at(start)) take_as_ground(passability, *spot, radius);
    const auto spot = ground_at(passability, start, "start");
    if (!spot || passability.enterable.test(*spot)) return spot;
    passability.enterable |= exit_cells(passability, *spot, radius);
    return spot;
}

Result<Spot> check_goal(const Passability& passability, const Point2& goal) {
    const auto spot = ground_at(passability, goal, "goal");
    if (!spot) return spot;
    const Point2 in_cells = to_cells(passability, goal, *spot);
    if (passability.enterable.test(*spot) && keeps_clear(passability, in_cells, in_cells)) return spot;
    return Error{Errc::kNoPath,
                 fmt::format("the goal ({:g}, {:g}) is nearer to an obstacle {}than the body radius of {} "
                             "m: give a point further away from it",
                             goal.x, goal.y, passability.options.on_known ? "or to unknown ground " : "",
                             passability.options.body_radius_m)};
}

std::vector<std::int32_t> disc_half_widths(double radius, bool to_square) {
    const double reach = radius + kRoundingCells;
    const double half_cell = to_square ? 0.5 : 0.0;
    std::vector<std::int32_t> widths;
    for (double dy = 0.0;; dy += 1.0) {
        const double above = std::max(dy - half_cell, 0.0);
        if (above > reach) return widths;
        widths.push_back(static_cast<std::int32_t>(std::sqrt(reach * reach - above * above) + half_cell));
    }
}

} // namespace scanloom::planning
