#include "core/planning/bit_grid.hpp"

#include <algorithm>
#include <cassert>

namespace scanloom::planning {
namespace {

/// Sets bits begin .. end - 1 of a row.
void set_run(std::span<std::uint64_t> row, std::int32_t begin, std::int32_t end) {
    for (std::int32_t x = begin; x < end;) {
        const std::int32_t bit = x & 63;
        const std::int32_t length = std::min(end - x, 64 - bit);
        row[static_cast<std::size_t>(x >> 6)] |= ~std::uint64_t{0} >> (64 - length) << bit;
        x += length;
    }
}

/// Returns the first column of the run of set bits that contains column x.
std::int32_t run_begin(std::span<const std::uint64_t> row, std::int32_t x) {
    for (;;) {
        const std::uint64_t word = row[static_cast<std::size_t>(x >> 6)];
        const int set_below = std::countl_one(word << (63 - (x & 63)));
        const std::int32_t begin = x - std::min(set_below, (x & 63) + 1) + 1;
        if ((begin & 63) != 0 || begin == 0) return begin;
        if (row[static_cast<std::size_t>(begin / 64 - 1)] >> 63 == 0) return begin;
        x = begin - 1;
    }
}

template <bool kWanted>
std::int32_t next(std::span<const std::uint64_t> row, std::int32_t x) {
    const auto width = static_cast<std::int32_t>(row.size() * 64);
    while (x < width) {
        const std::uint64_t word = row[static_cast<std::size_t>(x >> 6)];
        const std::uint64_t left = (kWanted ? word : ~word) >> (x & 63);
        if (left != 0) return x + std::countr_zero(left);
        x = (x | 63) + 1;
    }
    return width;
}

/// Extends each set bit by up to `columns` to the right. A run of covered + 1 cells can be shifted by its own length
/// without leaving a gap.
void widen_right(std::span<std::uint64_t> row, std::int32_t covered, std::int32_t columns) {
    while (covered < columns) {
        const std::int32_t step = std::min({covered + 1, columns - covered, 63});
        for (std::size_t word = row.size(); word-- > 0;) {
            row[word] |= row[word] << step | (word == 0 ? 0 : row[word - 1] >> (64 - step));
        }
        covered += step;
    }
}

void widen_left(std::span<std::uint64_t> row, std::int32_t covered, std::int32_t columns) {
    while (covered < columns) {
        const std::int32_t step = std::min({covered + 1, columns - covered, 63});
        for (std::size_t word = 0; word < row.size(); ++word) {
            row[word] |= row[word] >> step | (word + 1 == row.size() ? 0 : row[word + 1] << (64 - step));
        }
        covered += step;
    }
}

} // namespace

BitGrid::BitGrid(std::int32_t width, std::int32_t height)
    : width_(width), height_(height), stride_(static_cast<std::size_t>(width / 64) + 2),
      words_(stride_ * (static_cast<std::size_t>(height) + 2)) {
    assert(width % 64 == 0);
}

std::int64_t BitGrid::count() const noexcept {
    std::int64_t count = 0;
    for (const std::uint64_t word : words_) count += std::popcount(word);
    return count;
}

BitGrid& BitGrid::operator|=(const BitGrid& other) noexcept {
    for (std::size_t word = 0; word < words_.size(); ++word) words_[word] |= other.words_[word];
    return *this;
}

BitGrid& BitGrid::operator&=(const BitGrid& other) noexcept {
    for (std::size_t word = 0; word < words_.size(); ++word) words_[word] &= other.words_[word];
    return *this;
}

BitGrid& BitGrid::subtract(const BitGrid& other) noexcept {
    for (std::size_t word = 0; word < words_.size(); ++word) words_[word] &= ~other.words_[word];
    return *this;
}

std::int32_t next_set(std::span<const std::uint64_t> row, std::int32_t x) noexcept { return next<true>(row, x); }
std::int32_t next_clear(std::span<const std::uint64_t> row, std::int32_t x) noexcept { return next<false>(row, x); }

std::optional<Spot> first_set(const BitGrid& grid) noexcept {
    for (std::int32_t y = 0; y < grid.height(); ++y) {
        const std::int32_t x = next_set(grid.row(y), 0);
        if (x < grid.width()) return Spot{x, y};
    }
    return std::nullopt;
}

BitGrid connected(const BitGrid& grid, Spot seed) {
    BitGrid found(grid.width(), grid.height());
    if (!grid.test(seed)) return found;
    std::vector<Spot> seeds = {seed};
    while (!seeds.empty()) {
        const Spot at = seeds.back();
        seeds.pop_back();
        if (found.test(at)) continue;
        const std::int32_t begin = run_begin(grid.row(at.y), at.x);
        const std::int32_t end = next_clear(grid.row(at.y), at.x);
        set_run(found.row(at.y), begin, end);
        for (const std::int32_t y : {at.y - 1, at.y + 1}) {
            const auto adjacent_row = grid.row(y);
            for (std::int32_t x = next_set(adjacent_row, begin); x < end;
                 x = next_set(adjacent_row, next_clear(adjacent_row, x))) {
                if (!found.test({x, y})) seeds.push_back({x, y});
            }
        }
    }
    return found;
}

BitGrid dilated(const BitGrid& grid, std::span<const std::int32_t> half_widths) {
    BitGrid result(grid.width(), grid.height());
    std::vector<std::uint64_t> right(grid.row(0).size());
    std::vector<std::uint64_t> left(right.size());
    for (std::int32_t y = 0; y < grid.height(); ++y) {
        const auto row = grid.row(y);
        if (std::ranges::all_of(row, [](std::uint64_t word) { return word == 0; })) continue;
        std::ranges::copy(row, right.begin());
        std::ranges::copy(row, left.begin());
        std::int32_t covered = 0;
        for (auto dy = static_cast<std::int32_t>(half_widths.size()) - 1; dy >= 0; --dy) {
            const std::int32_t columns = half_widths[static_cast<std::size_t>(dy)];
            widen_right(right, covered, columns);
            widen_left(left, covered, columns);
            covered = columns;
            for (const std::int32_t other : {y - dy, y + dy}) {
                if (other < 0 || other >= grid.height()) continue;
                const auto target = result.row(other);
                for (std::size_t word = 0; word < target.size(); ++word) target[word] |= right[word] | left[word];
            }
        }
    }
    return result;
}

} // namespace scanloom::planning
