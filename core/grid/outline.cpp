#include "core/grid/outline.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace scanloom::grid {
namespace {

/// Directions of a walk along the sides of a cell, with the cell on the left: right along its bottom, up, left, down.
constexpr std::array<Cell, 4> kDirections = {Cell{1, 0}, Cell{0, 1}, Cell{-1, 0}, Cell{0, -1}};

Cell neighbour(Cell cell, std::size_t direction) {
    return {cell.i + kDirections[direction].i, cell.j + kDirections[direction].j};
}
std::size_t left_of(std::size_t direction) { return (direction + 1) % 4; }
std::size_t right_of(std::size_t direction) { return (direction + 3) % 4; }

/// Returns the corner where the walk along a side begins.
Cell first_corner(Cell cell, std::size_t side) {
    return {cell.i + (side == 1 || side == 2 ? 1 : 0), cell.j + (side >= 2 ? 1 : 0)};
}

bool by_rows(Cell a, Cell b) { return std::tie(a.j, a.i) < std::tie(b.j, b.i); }

/// Splits a walk into rings: a walk that reaches a corner twice goes around two rings that touch there. The first ring
/// is the one where the walk began.
/// @param corners  the corners where the walk turned, the first one not repeated
std::vector<Ring> rings_of(const std::vector<Cell>& corners) {
    std::vector<Ring> rings(1);
    Ring walked;
    std::map<Cell, std::size_t, decltype(&by_rows)> places(&by_rows); // indices into `walked`
    for (const Cell corner : corners) {
        const auto [place, is_new] = places.emplace(corner, walked.size());
        if (is_new) {
            walked.push_back(corner);
            continue;
        }
        const auto begin = walked.begin() + static_cast<std::ptrdiff_t>(place->second);
        Ring closed(begin, walked.end());
        for (auto left = begin + 1; left != walked.end(); ++left) places.erase(*left);
        walked.erase(begin + 1, walked.end());
        closed.push_back(corner);
        rings.push_back(std::move(closed));
    }
    walked.push_back(walked.front());
    rings.front() = std::move(walked);
    return rings;
}

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
                if (walked_[at][side] || find(neighbour(cells_[at], right_of(side)))) continue;
                auto& outline = outlines_[area_[at]];
                std::ranges::move(rings_of(walk(at, side)), std::back_inserter(outline)); // first the outer ring
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

    /// Starts a new area with all cells connected to a cell.
    void flood(std::size_t seed) {
        const std::size_t area = outlines_.size();
        outlines_.emplace_back();
        area_[seed] = area;
        for (std::vector<std::size_t> open = {seed}; !open.empty();) {
            const Cell cell = cells_[open.back()];
            open.pop_back();
            for (std::size_t direction = 0; direction < 4; ++direction) {
                const auto next = find(neighbour(cell, direction));
                if (!next || area_[*next] != kNone) continue;
                area_[*next] = area;
                open.push_back(*next);
            }
        }
    }

    /// Returns the corners of the walk that keeps a cell's side on its left. Where two cells touch at a corner only,
    /// the walk turns left and stays with its own cell.
    [[nodiscard]] std::vector<Cell> walk(std::size_t at, std::size_t side) {
        std::vector<Cell> corners;
        for (std::size_t before = right_of(side); !walked_[at][side];) {
            walked_[at][side] = true;
            if (side != before) corners.push_back(first_corner(cells_[at], side));
            before = side;
            const Cell forward = neighbour(cells_[at], side);
            const auto ahead = find(forward);
            const auto right = find(neighbour(forward, right_of(side)));
            if (!ahead) {
                side = left_of(side);
            } else if (!right) {
                at = *ahead;
            } else {
                at = *right;
                side = right_of(side);
            }
        }
        return corners;
    }

    std::vector<Cell> cells_; // by rows
    std::vector<std::array<bool, 4>> walked_;
    std::vector<std::size_t> area_;
    std::vector<Outline> outlines_;
};

} // namespace

std::vector<Outline> outlines_of(std::vector<Cell> cells) { return Tracer(std::move(cells)).trace(); }

} // namespace scanloom::grid
