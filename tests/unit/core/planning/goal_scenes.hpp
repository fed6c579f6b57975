#pragma once

#include "core/planning/goals.hpp"
#include "tests/support/plan_worlds.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

/// Maps and starts for tests of exploration goals.
namespace scanloom::testing_support {

using planning::ExplorationOptions;

/// In metres.
inline constexpr double kGoalCellSize = 0.05;

/// Returns options of a robot without extent.
inline ExplorationOptions for_a_point() {
    ExplorationOptions options;
    options.passability.body_radius_m = 0.0;
    return options;
}

/// Returns an office in which discs around `unseen_places` random cells are unexplored.
inline ClassView partly_seen(std::mt19937& random, int unseen_places) {
    const auto world = office(250, 250, static_cast<unsigned>(random()));
    std::vector<Cell> unseen;
    for (int n = 0; n < unseen_places; ++n) unseen.push_back({random_below(random, 250), random_below(random, 250)});
    return classified({0, 0, 250, 250}, 3, [&](Cell cell) {
        const bool hidden = std::ranges::any_of(
            unseen, [&](Cell place) { return std::hypot(cell.i - place.i, cell.j - place.j) < 12.0; });
        return hidden ? OccType::kUnexplored : world.at(cell);
    });
}

/// Returns the centre of a random cell of partly_seen(), or nothing if it is not free.
inline std::optional<Point2> somewhere_free(std::mt19937& random, const ClassView& view) {
    const Cell cell{random_below(random, 250), random_below(random, 250)};
    if (class_at(view, cell) != CellClass::kFree) return std::nullopt;
    return centre(cell, kGoalCellSize);
}

} // namespace scanloom::testing_support
