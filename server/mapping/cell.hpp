#pragma once

#include "common/geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace scanloom::mapping {

/// A cell of the unbounded, signed grid. Cell (0, 0) has its lower-left corner at the world origin;
/// i grows with x, j with y.
struct Cell {
    std::int32_t i = 0;
    std::int32_t j = 0;

    friend bool operator==(const Cell&, const Cell&) = default;
};

/// Between metres and cells. Source: design models, section 1.
class GridGeometry {
public:
    /// Pre: cell_size_m > 0.
    explicit GridGeometry(double cell_size_m) : cell_size_(cell_size_m), cells_per_metre_(1.0 / cell_size_m) {}

    [[nodiscard]] double cell_size() const noexcept { return cell_size_; }
    [[nodiscard]] double cells_per_metre() const noexcept { return cells_per_metre_; }

    /// The cell that holds a point. Multiplies, never divides: 0.3 / 0.1 floors to 2.
    [[nodiscard]] Cell cell_at(const Point2& point_map) const noexcept {
        return {static_cast<std::int32_t>(std::floor(point_map.x() * cells_per_metre_)),
                static_cast<std::int32_t>(std::floor(point_map.y() * cells_per_metre_))};
    }

    [[nodiscard]] Point2 centre_of(Cell cell) const noexcept {
        return {(cell.i + 0.5) * cell_size_, (cell.j + 0.5) * cell_size_};
    }

private:
    double cell_size_;
    double cells_per_metre_;
};

/// The cells (i, j) with i_begin <= i < i_end and j_begin <= j < j_end; empty by default.
struct CellBox {
    std::int32_t i_begin = std::numeric_limits<std::int32_t>::max();
    std::int32_t j_begin = std::numeric_limits<std::int32_t>::max();
    std::int32_t i_end = std::numeric_limits<std::int32_t>::min();
    std::int32_t j_end = std::numeric_limits<std::int32_t>::min();

    [[nodiscard]] bool empty() const noexcept { return i_begin >= i_end || j_begin >= j_end; }
    [[nodiscard]] std::int64_t width() const noexcept { return empty() ? 0 : std::int64_t{i_end} - i_begin; }
    [[nodiscard]] std::int64_t height() const noexcept { return empty() ? 0 : std::int64_t{j_end} - j_begin; }

    /// Grows to hold the cells i_begin..i_end - 1 of row j.
    void include_row(std::int32_t j, std::int32_t row_i_begin, std::int32_t row_i_end) noexcept {
        i_begin = std::min(i_begin, row_i_begin);
        i_end = std::max(i_end, row_i_end);
        j_begin = std::min(j_begin, j);
        j_end = std::max(j_end, j + 1);
    }

    void include(const CellBox& other) noexcept {
        i_begin = std::min(i_begin, other.i_begin);
        j_begin = std::min(j_begin, other.j_begin);
        i_end = std::max(i_end, other.i_end);
        j_end = std::max(j_end, other.j_end);
    }

    friend bool operator==(const CellBox&, const CellBox&) = default;
};

} // namespace scanloom::mapping
