#pragma once

#include "core/grid/chunk.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace scanloom::classify {

using grid::BitPlane;

static_assert(std::endian::native == std::endian::little, "cells are read eight at a time, the first one lowest");

namespace bits {

inline constexpr std::uint64_t kOnes = 0x0101010101010101;         ///< a one in each of 8 bytes
inline constexpr std::uint64_t kLowSevenBits = 0x7f7f7f7f7f7f7f7f; ///< bits 0..6 of each of 8 bytes

/// Packs the lowest bits of 8 bytes into bits 0..7, that of the lowest byte first.
/// Precondition: the other bits of the bytes are 0.
[[nodiscard]] constexpr std::uint64_t pack8(std::uint64_t bytes) noexcept { return (bytes * 0x0102040810204080) >> 56; }

/// Unpacks bits 0..7 into 8 bytes of 0 or 1; the inverse of pack8().
[[nodiscard]] constexpr std::uint64_t unpack8(std::uint64_t byte) noexcept {
    const std::uint64_t one_bit_each = (byte * kOnes) & 0x8040201008040201;
    return ((one_bit_each + kLowSevenBits) >> 7) & kOnes;
}

/// Returns 0x01 in each byte of `bytes` that is 0, and 0 in the others.
/// Precondition: no byte exceeds 0x80.
[[nodiscard]] constexpr std::uint64_t zero_bytes(std::uint64_t bytes) noexcept {
    return (~(bytes + kLowSevenBits) >> 7) & kOnes;
}

} // namespace bits

/// Returns a bit for each of the 64 cells of a row, set if the cell has the value.
template <class ByteEnum>
[[nodiscard]] inline std::uint64_t row_bits(const ByteEnum* cells, ByteEnum value) noexcept {
    static_assert(sizeof(ByteEnum) == 1);
    std::uint64_t row = 0;
    for (int eight = 0; eight < 8; ++eight) {
        std::uint64_t bytes = 0;
        std::memcpy(&bytes, cells + 8 * eight, 8);
        const std::uint64_t differs = bytes ^ (static_cast<std::uint64_t>(value) * bits::kOnes);
        row |= bits::pack8(bits::zero_bytes(differs)) << (8 * eight);
    }
    return row;
}

/// Returns the cells of a chunk that have the value.
/// Precondition: the enumeration's values are at most 0x7f.
template <class ByteEnum>
[[nodiscard]] inline BitPlane bits_where(const std::array<ByteEnum, 64 * 64>& cells, ByteEnum value) noexcept {
    BitPlane plane;
    for (std::size_t j = 0; j < plane.size(); ++j) plane[j] = row_bits(cells.data() + j * grid::kChunkSide, value);
    return plane;
}

} // namespace scanloom::classify
