#pragma once

#include "server/grid/bit_plane.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace scanloom::classify {

using grid::BitPlane;

static_assert(std::endian::native == std::endian::little, "cells are read eight at a time, the first one lowest");

namespace bits {

inline constexpr std::uint64_t kOnes = 0x0101010101010101; ///< a one in each of 8 bytes
inline constexpr std::uint64_t kLowSevenBits = 0x7f7f7f7f7f7f7f7f;

/// Bits 0..7: the lowest bits of 8 bytes, that of the lowest byte first. Pre: the other bits of the bytes are 0.
[[nodiscard]] constexpr std::uint64_t pack8(std::uint64_t bytes) noexcept { return (bytes * 0x0102040810204080) >> 56; }

/// The reverse of pack8(): 8 bytes of 0 or 1.
[[nodiscard]] constexpr std::uint64_t unpack8(std::uint64_t byte) noexcept {
    const std::uint64_t one_bit_each = (byte * kOnes) & 0x8040201008040201;
    return ((one_bit_each + kLowSevenBits) >> 7) & kOnes;
}

/// 0x01 in each byte of `bytes` that is 0. Pre: no byte exceeds 0x80.
[[nodiscard]] constexpr std::uint64_t zero_bytes(std::uint64_t bytes) noexcept {
    return (~(bytes + kLowSevenBits) >> 7) & kOnes;
}

} // namespace bits

/// Which of 64 cells in a row have the value.
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

/// Which cells of a chunk have the value. The enumeration's values are at most 0x7f.
template <class ByteEnum>
[[nodiscard]] inline BitPlane bits_where(const std::array<ByteEnum, 64 * 64>& cells, ByteEnum value) noexcept {
    BitPlane plane;
    for (std::size_t j = 0; j < plane.size(); ++j) plane[j] = row_bits(cells.data() + j * grid::kChunkSide, value);
    return plane;
}

} // namespace scanloom::classify
