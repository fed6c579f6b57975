#include "server/grid/outline.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

namespace scanloom::grid {
namespace {

/// Walking along a side of a cell with the cell on the left: right along its bottom, up, left, down.
constexpr std::array<Cell, 4> kWays = {Cell{1, 0}, Cell{0, 1}, Cell{-1, 0}, Cell{0, -1}};

Cell beside(Cell cell, std::size_t way) { return {cell.i + kWays[way].i, cell.j + kWays[way].j}; }
std::size_t left_of(std::size_t way) { return (way + 1) % 4; }
std::size_t right_of(std::size_t way) { return (way + 3) % 4; }

/// Where the walk along a side begins.
Cell first_corner(Cell cell, std::size_t side) {
    return {cell.i + (side == 1 || side == 2 ? 1 : 0), cell.j + (side >= 2 ? 1 : 0)};
}

bool by_rows(Cell a, Cell b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); }

class Tracer {
public:
    explicit Tracer(std::vector<Cell> cells)
        : cells_(std::move(cells)), walked_(cells_.size()), area_(cells_.size(), kNone) {
        std::ranges::sort(cells_, by_rows);
    }

    [[nodiscard]] std::vector<Outline> trace() {
        for (std::size_t at = 0; at < cells_.size(); ++at) {
            if (area_[at] == kNone) flood(at);
            for (std::size_t side = 0; side < 4; ++side) {
                if (walked_[at][side] || find(beside(cells_[at], right_of(side)))) continue;
                outlines_[area_[at]].push_back(walk(at, side)); // an area's first cell is at its outer ring
            }
        }
        return std::move(outlines_);
    }

private:
    static constexpr std::size_t kNone = SIZE_MAX;

    [[nodiscard]] std::optional<std::size_t> find(Cell cell) const {
        const auto found = std::ranges::lower_bound(cells_, cell, by_rows);
        if (found == cells_.end() || *found != cell) return std::nullopt;
        return static_cast<std::size_t>(found - cells_.begin());
    }

    /// A new area: all that hangs together with a cell.
    void flood(std::size_t seed) {
        const std::size_t area = outlines_.size();
        outlines_.emplace_back();
        area_[seed] = area;
        for (std::vector<std::size_t> open = {seed}; !open.empty();) {
            const Cell cell = cells_[open.back()];
            open.pop_back();
            for (std::size_t way = 0; way < 4; ++way) {
                const auto next = find(beside(cell, way));
                if (!next || area_[*next] != kNone) continue;
                area_[*next] = area;
                open.push_back(*next);
            }
        }
    }

    /// Where two cells touch in a corner only, the walk turns left and stays with its own.
    [[nodiscard]] Ring walk(std::size_t at, std::size_t side) {
        Ring ring;
        for (std::size_t before = right_of(side); !walked_[at][side];) {
            walked_[at][side] = true;
            if (side != before) ring.push_back(first_corner(cells_[at], side));
            before = side;
            const Cell forward = beside(cells_[at], side);
            const auto ahead = find(forward);
            const auto right = find(beside(forward, right_of(side)));
            if (!ahead) {
                side = left_of(side);
            } else if (!right) {
                at = *ahead;
            } else {
                at = *right;
                side = right_of(side);
            }
        }
        ring.push_back(ring.front());
        return ring;
    }

    std::vector<Cell> cells_; // by rows
    std::vector<std::array<bool, 4>> walked_;
    std::vector<std::size_t> area_;
    std::vector<Outline> outlines_;
};

} // namespace

std::vector<Outline> outlines_of(std::vector<Cell> cells) { return Tracer(std::move(cells)).trace(); }

} // namespace scanloom::grid
