#include "robot_client/drive/lanes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace scanloom::robot {
namespace {

/// Adjacent cells of one row: x_begin <= x < x_end.
struct Row {
    std::int32_t y = 0;
    std::int32_t x_begin = 0;
    std::int32_t x_end = 0;
};

using Cells = std::vector<std::uint8_t>;

bool is_set(const Ground& ground, const Cells& cells, Spot spot) {
    return ground.holds(spot) && cells[ground.index_of(spot)] != 0;
}

std::vector<Row> rows_at(const Ground& ground, const Cells& cells, std::int32_t y) {
    std::vector<Row> rows;
    for (std::int32_t x = 0; x < ground.plan().width; ++x) {
        if (!is_set(ground, cells, {x, y})) continue;
        if (!is_set(ground, cells, {x - 1, y})) rows.push_back({y, x, x});
        rows.back().x_end = x + 1;
    }
    return rows;
}

/// Returns the only one of `rows` that adjoins `row`, or nullopt if there is none or more than one.
std::optional<std::size_t> only_neighbour(const std::vector<Row>& rows, const Row& row) {
    std::optional<std::size_t> only;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        if (rows[n].x_begin >= row.x_end || row.x_begin >= rows[n].x_end) continue;
        if (only) return std::nullopt;
        only = n;
    }
    return only;
}

std::vector<std::vector<Row>> blocks_of_rows(const Ground& ground, const Cells& cells) {
    std::vector<std::vector<Row>> blocks;
    std::vector<Row> below;
    std::vector<std::size_t> blocks_below; // the block of each row below
    for (std::int32_t y = 0; y < ground.plan().height; ++y) {
        const auto rows = rows_at(ground, cells, y);
        std::vector<std::size_t> blocks_here;
        for (const Row& row : rows) {
            const auto under = only_neighbour(below, row);
            const bool goes_on = under && only_neighbour(rows, below[*under]);
            blocks_here.push_back(goes_on ? blocks_below[*under] : blocks.size());
            if (!goes_on) blocks.emplace_back();
            blocks[blocks_here.back()].push_back(row);
        }
        below = rows;
        blocks_below = std::move(blocks_here);
    }
    return blocks;
}

/// Returns whether each cell of a row has a cell of the area `up` rows above it.
bool borders(const Ground& ground, const Cells& cells, const Row& row, std::int32_t up) {
    for (std::int32_t x = row.x_begin; x < row.x_end; ++x) {
        if (!is_set(ground, cells, {x, row.y + up})) return false;
    }
    return true;
}

Block lanes_of(const Ground& ground, const Cells& cells, const std::vector<Row>& rows, std::int32_t spacing) {
    // If another block has a lane along the border, the first lane here is one spacing away from it.
    const bool open_below = borders(ground, cells, rows.front(), -1);
    const bool open_above = borders(ground, cells, rows.back(), 1);
    const std::int32_t first = open_below ? -1 : 0;
    const std::int32_t last = static_cast<std::int32_t>(rows.size()) - (open_above ? 0 : 1);
    const std::int32_t spaces = std::max(1, (last - first + spacing - 1) / spacing);
    Block block;
    for (std::int32_t n = 0; n <= spaces; ++n) {
        if ((n == 0 && open_below) || (n == spaces && (open_above || last == first))) continue;
        const double place = first + static_cast<double>(n) * (last - first) / spaces;
        const Row& row = rows[static_cast<std::size_t>(std::lround(place))];
        block.push_back({ground.centre_of({row.x_begin, row.y}), ground.centre_of({row.x_end - 1, row.y})});
    }
    return block;
}

} // namespace

std::vector<Block> lanes_over(const Ground& ground, const Cells& cells, double spacing_m) {
    const auto spacing = std::max(1, static_cast<std::int32_t>(spacing_m / ground.plan().cell_size + 1e-9));
    std::vector<Block> blocks;
    for (const auto& rows : blocks_of_rows(ground, cells)) {
        Block block = lanes_of(ground, cells, rows, spacing);
        if (!block.empty()) blocks.push_back(std::move(block));
    }
    return blocks;
}

} // namespace scanloom::robot
