#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::scan_matching {

/// A set of squares of a grid, to thin points: at most one point in each square.
/// Threads: one at a time.
class SquareSet {
public:
    /// @param side      metres, of a square
    /// @param expected  number of squares at most
    SquareSet(double side, std::size_t expected)
        : side_(side), slots_(std::bit_ceil(2 * expected + 16), kEmpty), mask_(slots_.size() - 1) {}

    /// Adds the square that contains a place.
    /// @param x  metres, within 2^31 squares of 0
    /// @param y  metres, likewise
    /// @return whether the square is new
    bool insert(double x, double y) {
        const auto column = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(x / side_)));
        const auto row = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(y / side_)));
        const std::uint64_t key = std::uint64_t{row} << 32U | column;
        for (std::size_t at = key * 0x9E37'79B9'7F4A'7C15U >> 20U;; ++at) {
            std::uint64_t& slot = slots_[at & mask_];
            if (slot == key) return false;
            if (slot != kEmpty) continue;
            slot = key;
            return true;
        }
    }

private:
    static constexpr std::uint64_t kEmpty = 0x8000'0000'8000'0000U; // the square that is farthest away

    double side_;
    std::vector<std::uint64_t> slots_;
    std::size_t mask_;
};

} // namespace scanloom::scan_matching
