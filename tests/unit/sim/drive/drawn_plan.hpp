#pragma once

#include "sim/drive/ground.hpp"

#include <string_view>
#include <vector>

namespace scanloom::robot {

/// Rows from the top, all of equal length: '.' is free, any other character is not. The lower left cell is (0, 0).
inline FloorPlan drawn_plan(const std::vector<std::string_view>& rows, double cell_size) {
    FloorPlan plan;
    plan.cell_size = cell_size;
    plan.width = static_cast<std::int32_t>(rows.front().size());
    plan.height = static_cast<std::int32_t>(rows.size());
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
        for (const char cell : *row) plan.is_free.push_back(cell == '.' ? 1 : 0);
    }
    return plan;
}

} // namespace scanloom::robot
