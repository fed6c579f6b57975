#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace scanloom::grid {

/// A cell of the unbounded grid, which has negative indices too. Cell (0, 0) has its lower-left corner at the world
/// origin; i increases with x, j with y.
struct Cell {
    std::int32_t i = 0; ///< column
    std::int32_t j = 0; ///< row

    friend bool operator==(const Cell&, const Cell&) = default;
};

/// The cells (i, j) with i_begin <= i < i_end and j_begin <= j < j_end; empty by default.
struct CellBox {
    std::int32_t i_begin = std::numeric_limits<std::int32_t>::max(); ///< first column
    std::int32_t j_begin = std::numeric_limits<std::int32_t>::max(); ///< first row
    std::int32_t i_end = std::numeric_limits<std::int32_t>::min();   ///< column after the last one
    std::int32_t j_end = std::numeric_limits<std::int32_t>::min();   ///< row after the last one

    /// Returns whether the box contains no cell.
    [[nodiscard]] bool empty() const noexcept { return i_begin >= i_end || j_begin >= j_end; }
    /// Returns the number of columns; 0 if the box is empty.
    [[nodiscard]] std::int64_t width() const noexcept { return empty() ? 0 : std::int64_t{i_end} - i_begin; }
    /// Returns the number of rows; 0 if the box is empty.
    [[nodiscard]] std::int64_t height() const noexcept { return empty() ? 0 : std::int64_t{j_end} - j_begin; }

    /// Extends the box to contain the cells row_i_begin..row_i_end - 1 of row j.
    /// @param j            row of the cells
    /// @param row_i_begin  first column
    /// @param row_i_end    column after the last one, greater than row_i_begin
    void include_row(std::int32_t j, std::int32_t row_i_begin, std::int32_t row_i_end) noexcept {
        i_begin = std::min(i_begin, row_i_begin);
        i_end = std::max(i_end, row_i_end);
        j_begin = std::min(j_begin, j);
        j_end = std::max(j_end, j + 1);
    }

    /// Extends the box to contain `other`.
    /// @param other  may be empty
    void include(const CellBox& other) noexcept {
        i_begin = std::min(i_begin, other.i_begin);
        j_begin = std::min(j_begin, other.j_begin);
        i_end = std::max(i_end, other.i_end);
        j_end = std::max(j_end, other.j_end);
    }

    friend bool operator==(const CellBox&, const CellBox&) = default;
};

} // namespace scanloom::grid
