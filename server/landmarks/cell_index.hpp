#pragma once

#include "common/geometry/pose2.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::landmarks {

/// Points by the squares of a grid that they are in.
class CellIndex {
public:
    struct Cell {
        std::int64_t j = 0; ///< row
        std::int64_t i = 0; ///< column
        std::uint32_t begin = 0;
        std::uint32_t end = 0; ///< its points are order()[begin .. end)
    };

    static constexpr std::int64_t kReach = 2;

    /// Squares so small that any two points of one are within `radius` of each other, and so large that whatever is
    /// within it of a point is at most kReach squares away.
    /// Pre  the points pass check_points(); radius >= 1e-6.
    /// Cost n log n.
    [[nodiscard]] static CellIndex of_radius(std::span<const Point2> points, double radius);

    /// Squares of a given side, metres. The same holds.
    [[nodiscard]] static CellIndex of_side(std::span<const Point2> points, double side) { return {points, side}; }

    /// The points' indices by cells; rising within each.
    [[nodiscard]] const std::vector<std::uint32_t>& order() const noexcept { return order_; }
    /// The cells that hold points, by rows.
    [[nodiscard]] const std::vector<Cell>& cells() const noexcept { return cells_; }
    [[nodiscard]] std::span<const std::uint32_t> points_of(const Cell& cell) const {
        return std::span(order_).subspan(cell.begin, cell.end - cell.begin);
    }

    /// Calls `visit` with the number of each cell around one, in the order of cells(), until it returns false.
    /// The cell itself is not among them.
    template <class Visit>
    void around(std::size_t cell, Visit visit) const {
        for (std::int64_t row = -kReach; row <= kReach; ++row) {
            const std::int64_t j = cells_[cell].j + row;
            const std::int64_t last = cells_[cell].i + kReach;
            for (std::size_t other = first_from(j, cells_[cell].i - kReach);
                 other < cells_.size() && cells_[other].j == j && cells_[other].i <= last; ++other) {
                if (other != cell && !visit(other)) return;
            }
        }
    }

private:
    CellIndex(std::span<const Point2> points, double side);

    /// The first cell that does not come before (j, i).
    [[nodiscard]] std::size_t first_from(std::int64_t j, std::int64_t i) const;

    std::vector<std::uint32_t> order_;
    std::vector<Cell> cells_;
};

} // namespace scanloom::landmarks
