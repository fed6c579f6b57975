#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::planning {

/// A cell of a window of the map: its column from the window's left edge, its row from the bottom edge.
struct Spot {
    std::int32_t x = 0; ///< column, from the window's left edge
    std::int32_t y = 0; ///< row, from the window's bottom edge

    friend bool operator==(const Spot&, const Spot&) = default;
};

/// One bit for each cell of a window; a word holds 64 cells of a row.
///
/// A border of clear bits surrounds the window, so reading a cell's neighbours needs no bounds check.
class BitGrid {
public:
    BitGrid() : BitGrid(0, 0) {}

    /// Creates a grid with all bits clear.
    /// @param width   cells
    /// @param height  cells
    /// Precondition: `width` is a multiple of 64.
    BitGrid(std::int32_t width, std::int32_t height);

    /// Returns the number of columns.
    [[nodiscard]] std::int32_t width() const noexcept { return width_; }
    /// Returns the number of rows.
    [[nodiscard]] std::int32_t height() const noexcept { return height_; }

    /// Returns whether the cell's bit is set.
    /// @param at  a cell of the window or of the border around it
    /// Precondition: -1 <= x <= width(), -1 <= y <= height().
    [[nodiscard]] bool test(Spot at) const noexcept { return (words_[word_of(at)] >> (at.x & 63) & 1) != 0; }

    /// Sets a cell's bit. Precondition: the cell is in the window.
    void set(Spot at) noexcept { words_[word_of(at)] |= std::uint64_t{1} << (at.x & 63); }
    /// Clears a cell's bit. Precondition: the cell is in the window.
    void clear(Spot at) noexcept { words_[word_of(at)] &= ~(std::uint64_t{1} << (at.x & 63)); }

    /// Returns the 3 x 3 bits around a cell: bit 3 (dy + 1) + (dx + 1).
    /// @param at  a cell of the window
    [[nodiscard]] std::uint32_t around(Spot at) const noexcept {
        return three(at.x, at.y - 1) | three(at.x, at.y) << 3 | three(at.x, at.y + 1) << 6;
    }

    /// Returns the words of a row. The lowest bit of the first word is the leftmost cell.
    /// @param y  0 <= y < height()
    [[nodiscard]] std::span<std::uint64_t> row(std::int32_t y) noexcept {
        return {words_.data() + word_of({0, y}), static_cast<std::size_t>(width_ / 64)};
    }
    /// Returns the words of a row. The lowest bit of the first word is the leftmost cell.
    /// @param y  0 <= y < height()
    [[nodiscard]] std::span<const std::uint64_t> row(std::int32_t y) const noexcept {
        return {words_.data() + word_of({0, y}), static_cast<std::size_t>(width_ / 64)};
    }

    /// Returns the number of set cells.
    [[nodiscard]] std::int64_t count() const noexcept;

    /// Sets the cells that are set in another grid of the same size.
    BitGrid& operator|=(const BitGrid& other) noexcept;
    /// Clears the cells that are clear in another grid of the same size.
    BitGrid& operator&=(const BitGrid& other) noexcept;
    /// Clears the cells that are set in another grid of the same size.
    BitGrid& subtract(const BitGrid& other) noexcept;

    friend bool operator==(const BitGrid&, const BitGrid&) = default;

private:
    [[nodiscard]] std::size_t word_of(Spot at) const noexcept {
        return static_cast<std::size_t>(at.y + 1) * stride_ + static_cast<std::size_t>((at.x >> 6) + 1);
    }

    /// Returns the bits x - 1 .. x + 1 of a row.
    [[nodiscard]] std::uint32_t three(std::int32_t x, std::int32_t y) const noexcept {
        const std::uint64_t* word = words_.data() + word_of({x, y});
        const int bit = x & 63;
        const std::uint64_t here = bit == 0 ? *word << 1 | word[-1] >> 63 : *word >> (bit - 1);
        const std::uint64_t beyond = bit == 63 ? word[1] << 2 : 0;
        return static_cast<std::uint32_t>((here | beyond) & 7);
    }

    std::int32_t width_;
    std::int32_t height_;
    std::size_t stride_; // words
    std::vector<std::uint64_t> words_;
};

/// Calls visit(Spot) for each set cell: rows from the bottom, each row from the left.
template <class Visit>
void for_each_set(const BitGrid& grid, Visit&& visit) {
    for (std::int32_t y = 0; y < grid.height(); ++y) {
        const auto row = grid.row(y);
        for (std::size_t word = 0; word < row.size(); ++word) {
            for (std::uint64_t bits = row[word]; bits != 0; bits &= bits - 1) {
                visit(Spot{static_cast<std::int32_t>(64 * word) + std::countr_zero(bits), y});
            }
        }
    }
}

/// Returns the first column >= x whose bit is set, or the row's width if there is none.
/// @param row  words of a row; see BitGrid::row()
/// @param x    0 or more
[[nodiscard]] std::int32_t next_set(std::span<const std::uint64_t> row, std::int32_t x) noexcept;
/// Returns the first column >= x whose bit is clear, or the row's width if there is none.
/// @param row  words of a row; see BitGrid::row()
/// @param x    0 or more
[[nodiscard]] std::int32_t next_clear(std::span<const std::uint64_t> row, std::int32_t x) noexcept;

/// Returns the leftmost set cell of the lowest row that has one, or nullopt if no cell is set.
[[nodiscard]] std::optional<Spot> first_set(const BitGrid& grid) noexcept;

/// Returns the set cells that are 4-connected to `seed`; none if `seed` is not set.
/// @param grid  cells to fill
/// @param seed  a cell of the window
/// Source: scan-line seed fill: Smith, Tint Fill (SIGGRAPH 1979).
[[nodiscard]] BitGrid connected(const BitGrid& grid, Spot seed);

/// Returns a grid in which each cell near a set cell of `grid` is set.
/// @param grid         cells to extend
/// @param half_widths  half_widths[|dy|] is how many columns to either side are set in the rows dy above and below;
///     does not increase
[[nodiscard]] BitGrid dilated(const BitGrid& grid, std::span<const std::int32_t> half_widths);

} // namespace scanloom::planning
