#include "server/planning/sweep.hpp"

#include <optional>
#include <utility>

namespace scanloom::planning {
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
