#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::planning {

/// A place in a window of the map: x columns from its left edge, y rows from its bottom.
struct Spot {
    std::int32_t x = 0;
    std::int32_t y = 0;

    friend bool operator==(const Spot&, const Spot&) = default;
};

/// One bit per cell of a window, 64 cells of a row in a word. A frame of clear bits surrounds them, so that whoever
/// looks at a cell's neighbours needs no other test for the edge.
class BitGrid {
public:
    BitGrid() : BitGrid(0, 0) {}

    /// All clear. Pre  width is a multiple of 64.
    BitGrid(std::int32_t width, std::int32_t height);

    [[nodiscard]] std::int32_t width() const noexcept { return width_; }
    [[nodiscard]] std::int32_t height() const noexcept { return height_; }

    /// Pre  -1 <= x <= width, -1 <= y <= height.
    [[nodiscard]] bool test(Spot at) const noexcept { return (words_[word_of(at)] >> (at.x & 63) & 1) != 0; }

    void set(Spot at) noexcept { words_[word_of(at)] |= std::uint64_t{1} << (at.x & 63); }
    void clear(Spot at) noexcept { words_[word_of(at)] &= ~(std::uint64_t{1} << (at.x & 63)); }

    /// The 3 x 3 bits around a cell: bit 3 (dy + 1) + (dx + 1).
    [[nodiscard]] std::uint32_t around(Spot at) const noexcept {
        return three(at.x, at.y - 1) | three(at.x, at.y) << 3 | three(at.x, at.y + 1) << 6;
    }

    /// The words of a row, the leftmost cell in the lowest bit of the first.
    [[nodiscard]] std::span<std::uint64_t> row(std::int32_t y) noexcept {
        return {words_.data() + word_of({0, y}), static_cast<std::size_t>(width_ / 64)};
    }
    [[nodiscard]] std::span<const std::uint64_t> row(std::int32_t y) const noexcept {
        return {words_.data() + word_of({0, y}), static_cast<std::size_t>(width_ / 64)};
    }

    [[nodiscard]] std::int64_t count() const noexcept;

    /// These work cell by cell with another grid of the same size.
    BitGrid& operator|=(const BitGrid& other) noexcept;
    BitGrid& operator&=(const BitGrid& other) noexcept;
    BitGrid& subtract(const BitGrid& other) noexcept;

    friend bool operator==(const BitGrid&, const BitGrid&) = default;

private:
    [[nodiscard]] std::size_t word_of(Spot at) const noexcept {
        return static_cast<std::size_t>(at.y + 1) * stride_ + static_cast<std::size_t>((at.x >> 6) + 1);
    }

    /// The bits x - 1 .. x + 1 of a row.
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

/// Calls visit(Spot) for each set cell, by rows from the bottom, then from the left.
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

/// The first column >= x whose bit is set (or clear) in a row; the row's width when there is none.
[[nodiscard]] std::int32_t next_set(std::span<const std::uint64_t> row, std::int32_t x) noexcept;
[[nodiscard]] std::int32_t next_clear(std::span<const std::uint64_t> row, std::int32_t x) noexcept;

/// The first set cell, by rows from the bottom, then from the left.
[[nodiscard]] std::optional<Spot> first_set(const BitGrid& grid) noexcept;

/// The set cells that hang together with a set cell, from one to the next of the 4 beside it.
/// Source  scan-line seed fill: Smith, Tint Fill (SIGGRAPH 1979).
[[nodiscard]] BitGrid connected(const BitGrid& grid, Spot seed);

/// Every cell within reach of a set one: up to half_widths[|dy|] columns away in the rows dy above and below.
/// Pre  half_widths does not rise.
[[nodiscard]] BitGrid dilated(const BitGrid& grid, std::span<const std::int32_t> half_widths);

} // namespace scanloom::planning
