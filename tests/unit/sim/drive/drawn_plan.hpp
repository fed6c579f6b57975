#pragma once

#include "sim/drive/ground.hpp"

#include <string_view>
#include <vector>

namespace scanloom::sim {

/// Rows from the top, all of equal length: '.' is free, any other character is not. The lower left cell is (0, 0).
inline FloorPlan drawn_plan(const std::vector<std::string_view>& rows, double cell_size) {
    const auto width = static_cast<std::int32_t>(rows.front().size());
    const auto height = static_cast<std::int32_t>(rows.size());
    FloorPlan plan(cell_size, {0, 0, width, height});
    for (std::int32_t y = 0; y < height; ++y) {
        for (std::int32_t x = 0; x < width; ++x) {
            if (rows[static_cast<std::size_t>(height - 1 - y)][static_cast<std::size_t>(x)] == '.')
                plan.free.set({x, y});
        }
    }
    return plan;
}

} // namespace scanloom::sim
