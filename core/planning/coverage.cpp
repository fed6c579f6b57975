#include "core/planning/coverage.hpp"

#include "core/planning/coverage_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace scanloom::planning {
namespace {

/// What to cover, and from where.
struct Task {
    Passability passability;
    Spot start;
    BitGrid exit_cells;              ///< cells to leave a narrow start by; not entered again
    BitGrid places;                  ///< where the body's centre can be
    BitGrid free;                    ///< free cells of the region
    BitGrid reachable;               ///< cells of `free` within reach of a place
    std::vector<std::int32_t> reach; ///< half widths of the body's disc
    std::int32_t spacing;            ///< cells
};

Result<std::int32_t> spacing_cells(const CoverageOptions& options, double cell_size_m) {
    const double body = 2.0 * options.passability.body_radius_m;
    const double spacing = options.spacing_m.value_or(body);
    const double cells = spacing / cell_size_m + 1e-9;
    if (!(spacing >= 0.0)) {
        return Error{Errc::kInvalidField, fmt::format("spacing is {} m; 0 or more is needed", spacing)};
    }
    if (!(cells <= body / cell_size_m + 1.0 + 1e-6)) {
        return Error{
            Errc::kInvalidField,
            fmt::format("spacing is {} m; rows more than {:g} m apart leave ground between them that a body of "
                        "radius {} m does not reach: give a smaller spacing or a larger body_radius",
                        spacing, body + cell_size_m, options.passability.body_radius_m)};
    }
    return std::max(static_cast<std::int32_t>(cells), 1);
}

/// Connected places, and the ground within reach of them.
struct Room {
    BitGrid places;
    BitGrid reachable;
};

/// Returns the room in which the body reaches the most ground. A start in a gap may lead to several rooms that no path
/// for the body connects.
Room best_of_rooms(const Passability& passability, Spot start, std::span<const std::int32_t> reach,
                   const BitGrid& free) {
    BitGrid left = connected(passability.enterable, start);
    left &= passability.fits;
    const BitGrid none(left.width(), left.height());
    Room best{none, none};
    std::int64_t most = 0;
    while (const auto seed = first_set(left)) {
        Room room{connected(passability.fits, *seed), none};
        left.subtract(room.places);
        room.reachable = dilated(room.places, reach);
        room.reachable &= free;
        if (room.reachable.count() <= most) continue;
        most = room.reachable.count();
        best = std::move(room);
    }
    return best;
}

Result<Task> make_task(const classify::ClassView& classes, double cell_size_m, const Point2& start,
                       const CoverageOptions& options) {
    PassabilityOptions known_ground = options.passability;
    known_ground.allow_unknown = false;
    auto passability = make_passability(classes, cell_size_m, known_ground, {&start, 1});
    if (!passability) return passability.error();
    const auto spacing = spacing_cells(options, cell_size_m);
    if (!spacing) return spacing.error();
    const auto spot = open_start(*passability, start);
    if (!spot) return spot.error();
    BitGrid free = passability->ground;
    if (!options.region.empty()) {
        const auto inside = cells_inside(*passability, options.region);
        if (!inside) return inside.error();
        free &= *inside;
    }
    if (free.count() == 0) {
        return Error{Errc::kNoPath,
                     "the region holds the centre of no free cell of the explored area around the start: "
                     "give a larger or another region, or another start"};
    }
    auto reach = disc_half_widths(known_ground.body_radius_m / cell_size_m, false);
    auto [places, reachable] = best_of_rooms(*passability, *spot, reach, free);
    if (reachable.count() == 0) {
        return Error{Errc::kNoPath, fmt::format("from ({:g}, {:g}) a body of radius {} m reaches no free cell of the "
                                                "region: give another start or region",
                                                start.x, start.y, known_ground.body_radius_m)};
    }
    BitGrid exit_cells = passability->enterable;
    exit_cells.subtract(passability->fits);
    passability->enterable = places;
    passability->enterable |= exit_cells;
    return Task{std::move(*passability), *spot,           std::move(exit_cells),
                std::move(places),       std::move(free), std::move(reachable),
                std::move(reach),        *spacing};
}

/// The cells visited so far, and those left to cover.
class Tour {
public:
    Tour(Task& task, const MayGoOn& may_go_on)
        : task_(task), may_go_on_(may_go_on), search_(task.passability), left_(task.reachable), cells_{task.start} {
        cover(task.start);
    }

    [[nodiscard]] Spot at() const { return cells_.back(); }
    [[nodiscard]] const BitGrid& left() const { return left_; }
    [[nodiscard]] const std::vector<Spot>& cells() const { return cells_; }

    [[nodiscard]] Result<> go_to(Spot goal) {
        if (may_go_on_) {
            if (auto may = may_go_on_(); !may) return may;
        }
        search_.between(at(), goal);
        append(search_.path_to(goal));
        if (!std::exchange(has_left_, true)) task_.passability.enterable = task_.places; // without exit_cells
        return {};
    }

    /// Moves straight along the current row, whatever that costs.
    /// Precondition: all cells between are places.
    void go_along_row(Spot goal) {
        while (at().x != goal.x) step({at().x + (goal.x > at().x ? 1 : -1), goal.y});
    }

    /// Calls `then` with each cell that is covered from now on.
    void when_covered(std::function<void(Spot)> then) { when_covered_ = std::move(then); }

    /// Returns the nearest of the wanted cells.
    /// Precondition: one of them can be reached.
    [[nodiscard]] Spot nearest(const BitGrid& wanted) {
        const auto nearest = search_.nearest(at(), wanted);
        assert(nearest);
        return *nearest;
    }

private:
    void append(const std::vector<Spot>& path) {
        for (std::size_t n = 1; n < path.size(); ++n) step(path[n]);
    }

    void step(Spot next) {
        cells_.push_back(next);
        cover(next);
    }

    void cover(Spot centre) {
        if (!task_.places.test(centre)) return; // next to a wall the disc would reach through it
        const auto height = static_cast<std::int32_t>(task_.reach.size());
        for (std::int32_t dy = 1 - height; dy < height; ++dy) {
            const std::int32_t y = centre.y + dy;
            if (y < 0 || y >= left_.height()) continue;
            const std::int32_t width = task_.reach[static_cast<std::size_t>(std::abs(dy))];
            const std::int32_t end = std::min(centre.x + width + 1, left_.width());
            for (std::int32_t x = next_set(left_.row(y), std::max(centre.x - width, 0)); x < end;
                 x = next_set(left_.row(y), x + 1)) {
                left_.clear({x, y});
                if (when_covered_) when_covered_({x, y});
            }
        }
    }

    Task& task_;
    const MayGoOn& may_go_on_;
    bool has_left_ = false; // whether the tour has left the start
    CostSearch search_;
    BitGrid left_; // cells of task_.reachable not covered yet
    std::vector<Spot> cells_;
    std::function<void(Spot)> when_covered_;
};

/// Sweeps all rows of a block, starting at an end of its first or last row.
Result<> sweep(Tour& tour, const SweepBlock& block, Spot entry) {
    SweepBlock rows = block;
    if (entry.y != rows.front().y) std::ranges::reverse(rows);
    for (const SweepRow& row : rows) {
        const bool from_left = std::abs(tour.at().x - row.left().x) <= std::abs(tour.at().x - row.right().x);
        if (auto gone = tour.go_to(from_left ? row.left() : row.right()); !gone) return gone;
        tour.go_along_row(from_left ? row.right() : row.left());
    }
    return {};
}

Result<> sweep_all(Tour& tour, const Task& task) {
    BitGrid ground = task.places;
    ground &= task.free;
    const auto blocks = sweep_blocks(ground, task.spacing);
    std::multimap<std::pair<std::int32_t, std::int32_t>, std::size_t> entries; // (y, x) of the blocks' corners
    BitGrid wanted(ground.width(), ground.height());
    for (std::size_t n = 0; n < blocks.size(); ++n) {
        for (const SweepRow& row : {blocks[n].front(), blocks[n].back()}) {
            for (const Spot corner : {row.left(), row.right()}) {
                entries.emplace(std::pair{corner.y, corner.x}, n);
                wanted.set(corner);
            }
        }
    }
    std::vector<bool> swept(blocks.size());
    for (std::size_t done = 0; done < blocks.size();) {
        const Spot entry = tour.nearest(wanted);
        wanted.clear(entry);
        const auto [first, last] = entries.equal_range({entry.y, entry.x});
        for (auto block = first; block != last; ++block) {
            if (swept[block->second]) continue;
            swept[block->second] = true;
            if (auto gone = tour.go_to(entry); !gone) return gone;
            if (auto swept_it = sweep(tour, blocks[block->second], entry); !swept_it) return swept_it;
            ++done;
        }
    }
    return {};
}

/// Returns the offsets of the cells in the body's disc, the nearest first.
std::vector<Spot> offsets_by_distance(const std::vector<std::int32_t>& reach) {
    std::vector<Spot> offsets;
    const auto height = static_cast<std::int32_t>(reach.size());
    for (std::int32_t dy = 1 - height; dy < height; ++dy) {
        const std::int32_t width = reach[static_cast<std::size_t>(std::abs(dy))];
        for (std::int32_t dx = -width; dx <= width; ++dx) offsets.push_back({dx, dy});
    }
    std::ranges::stable_sort(offsets, {}, [](Spot offset) { return offset.x * offset.x + offset.y * offset.y; });
    return offsets;
}

/// Covers the cells that the rows left out: goes to the place nearest to each, always to the nearest of these places. A
/// place is skipped if all its cells were covered on the path to others.
Result<> fetch_what_is_left(Tour& tour, const Task& task) {
    const auto offsets = offsets_by_distance(task.reach);
    const auto place_for = [&](Spot cell) {
        for (const Spot offset : offsets) {
            const Spot place{cell.x + offset.x, cell.y + offset.y};
            const bool inside =
                place.x >= 0 && place.y >= 0 && place.x < task.places.width() && place.y < task.places.height();
            if (inside && task.places.test(place)) return place;
        }
        assert(false); // the cell is reachable
        return cell;
    };
    std::map<std::pair<std::int32_t, std::int32_t>, std::int64_t>
        cells_left; // number of cells for which the place (y, x) is the nearest
    BitGrid wanted(task.places.width(), task.places.height());
    for_each_set(tour.left(), [&](Spot cell) {
        const Spot place = place_for(cell);
        wanted.set(place);
        ++cells_left[{place.y, place.x}];
    });
    tour.when_covered([&](Spot cell) {
        const Spot place = place_for(cell);
        const auto left = cells_left.find({place.y, place.x});
        if (--left->second > 0) return;
        cells_left.erase(left);
        wanted.clear(place);
    });
    while (!cells_left.empty()) {
        if (auto gone = tour.go_to(tour.nearest(wanted)); !gone) return gone;
    }
    return {};
}

} // namespace

Result<Coverage> plan_coverage(const classify::ClassView& classes, double cell_size_m, const Point2& start,
                               const CoverageOptions& options, const MayGoOn& may_go_on) {
    auto task = make_task(classes, cell_size_m, start, options);
    if (!task) return task.error();
    Tour tour(*task, may_go_on);
    if (auto swept = sweep_all(tour, *task); !swept) return swept.error();
    if (auto fetched = fetch_what_is_left(tour, *task); !fetched) return fetched.error();
    task->passability.enterable |= task->exit_cells; // the path starts there
    Coverage coverage;
    const Point2 end = task->passability.centre_of(tour.at());
    coverage.path = to_path(task->passability, tour.cells(), start, end, Shape::kSteps);
    coverage.free_cells = task->free.count();
    coverage.covered_cells = task->reachable.count() - tour.left().count();
    BitGrid unreachable = task->free;
    unreachable.subtract(task->reachable);
    for_each_set(unreachable, [&](Spot spot) { coverage.unreachable.push_back(task->passability.cell_at(spot)); });
    coverage.unreachable_m2 = static_cast<double>(coverage.unreachable.size()) * cell_size_m * cell_size_m;
    coverage.fraction = static_cast<double>(coverage.covered_cells) / static_cast<double>(coverage.free_cells);
    return coverage;
}

} // namespace scanloom::planning
