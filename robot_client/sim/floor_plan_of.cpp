#include "robot_client/sim/floor_plan_of.hpp"

#include <algorithm>
#include <iterator>

namespace scanloom::robot {

FloorPlan floor_plan_of(const TruthGrid& truth) {
    FloorPlan plan{truth.cell_size, truth.i_begin, truth.j_begin, truth.width, truth.height, {}};
    plan.is_free.reserve(truth.cells.size());
    std::ranges::transform(truth.cells, std::back_inserter(plan.is_free),
                           [](Truth cell) { return static_cast<std::uint8_t>(cell == Truth::kFree ? 1 : 0); });
    return plan;
}

} // namespace scanloom::robot
