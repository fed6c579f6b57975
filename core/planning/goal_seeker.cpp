#include "core/planning/goal_seeker.hpp"

#include "core/planning/line_of_sight.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

namespace scanloom::planning {

using classify::Frontier;

double square_of_distance(grid::Cell a, grid::Cell b) noexcept {
    const double di = static_cast<double>(a.i) - b.i;
    const double dj = static_cast<double>(a.j) - b.j;
    return di * di + dj * dj;
}

grid::Cell nearest_cell(const Frontier& frontier, grid::Cell to) {
    const auto& cells = frontier.cells; // sorted by rows: a binary search finds the nearest cell of a row
    const auto by_rows = [](grid::Cell cell) { return std::pair(cell.j, cell.i); };
    grid::Cell nearest = cells.front();
    double least = square_of_distance(nearest, to);
    const auto consider = [&](grid::Cell cell) {
        const double distance = square_of_distance(cell, to);
        if (distance > least || (distance == least && by_rows(cell) >= by_rows(nearest))) return;
        nearest = cell;
        least = distance;
    };
    const auto consider_row = [&](std::int64_t j) {
        if (j < frontier.bounds.j_begin || j >= frontier.bounds.j_end) return;
        const auto row = static_cast<std::int32_t>(j);
        const auto right = std::ranges::lower_bound(cells, std::pair(row, to.i), {}, by_rows);
        if (right != cells.end() && right->j == row) consider(*right);
        if (right != cells.begin() && std::prev(right)->j == row) consider(*std::prev(right));
    };
    for (std::int64_t away = 0; static_cast<double>(away * away) <= least; ++away) {
        consider_row(to.j - away);
        consider_row(to.j + away);
    }
    return nearest;
}

GoalSeeker::GoalSeeker(const Passability& passability, const CostSearch& search, std::int32_t rings)
    : passability_(passability), search_(search), rings_(rings),
      seen_(passability_.ground.width(), passability_.ground.height()) {}

std::optional<FrontierGoal> GoalSeeker::seek(const Frontier& frontier, std::size_t place) {
    std::vector<Spot> ring = cells_next_to(frontier);
    std::vector<Spot> all_seen = ring;
    std::optional<Spot> fallback;
    std::optional<Spot> best;
    for (std::int32_t step = 1; step <= rings_ && !ring.empty(); ++step) {
        best = cheapest(ring, false, frontier);
        if (best) break;
        if (!fallback) fallback = cheapest(ring, true, frontier);
        ring = around(ring);
        all_seen.insert(all_seen.end(), ring.begin(), ring.end());
    }
    for (const Spot spot : all_seen) seen_.clear(spot);
    if (!best) best = fallback;
    if (!best) return std::nullopt;
    return goal_at(*best, frontier, place);
}

/// Returns the free cells among the 8 neighbours of each cell of the frontier; each frontier cell has one.
std::vector<Spot> GoalSeeker::cells_next_to(const Frontier& frontier) {
    std::vector<Spot> ring;
    for (const grid::Cell cell : frontier.cells) {
        for (std::int32_t dj = -1; dj <= 1; ++dj) {
            for (std::int32_t di = -1; di <= 1; ++di) {
                const auto spot = passability_.spot_of({cell.i + di, cell.j + dj});
                if (spot) add(*spot, ring);
            }
        }
    }
    return ring;
}

/// Returns the free cells next to a ring's cells that were not visited yet. Only straight steps are taken: they cannot
/// pass a wall, even a diagonal one of one cell's thickness.
std::vector<Spot> GoalSeeker::around(const std::vector<Spot>& ring) {
    std::vector<Spot> next;
    for (const Spot at : ring) {
        for (const Spot adjacent :
             {Spot{at.x + 1, at.y}, Spot{at.x - 1, at.y}, Spot{at.x, at.y + 1}, Spot{at.x, at.y - 1}}) {
            add(adjacent, next);
        }
    }
    return next;
}

void GoalSeeker::add(Spot spot, std::vector<Spot>& ring) {
    if (!passability_.ground.test(spot) || seen_.test(spot)) return;
    seen_.set(spot);
    ring.push_back(spot);
}

/// Returns the cheapest cell of the ring that can be reached and sees the frontier.
std::optional<Spot> GoalSeeker::cheapest(const std::vector<Spot>& ring, bool in_danger,
                                         const Frontier& frontier) const {
    std::optional<Spot> best;
    double least = std::numeric_limits<double>::infinity();
    for (const Spot spot : ring) {
        if (passability_.danger.test(spot) != in_danger || !passability_.fits.test(spot)) continue;
        const double cost = search_.cost(spot);
        const bool before = best && (spot.y < best->y || (spot.y == best->y && spot.x < best->x));
        if (cost > least || (cost == least && !before) || std::isinf(cost)) continue;
        const auto target = passability_.spot_of(nearest_cell(frontier, passability_.cell_at(spot)));
        if (target && !sees(spot, *target)) continue;
        best = spot;
        least = cost;
    }
    return best;
}

bool GoalSeeker::sees(Spot from, Spot to) const {
    return planning::sees({from.x, from.y}, {to.x, to.y}, [&](grid::Cell at) {
        return passability_.occupied.test({at.i, at.j});
    });
}

FrontierGoal GoalSeeker::goal_at(Spot spot, const Frontier& frontier, std::size_t place) const {
    const grid::Cell cell = passability_.cell_at(spot);
    const auto path = search_.path_to(spot);
    double length = 0.0; // cells
    for (std::size_t at = 0; at + 1 < path.size(); ++at) {
        length += std::hypot(path[at + 1].x - path[at].x, path[at + 1].y - path[at].y);
    }
    return {place,
            cell,
            nearest_cell(frontier, cell),
            passability_.danger.test(spot),
            search_.cost(spot) * passability_.cell_size_m,
            length * passability_.cell_size_m};
}

} // namespace scanloom::planning
