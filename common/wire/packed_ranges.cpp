#include "common/wire/packed_ranges.hpp"

#include "common/scan/limits.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace scanloom::wire {
namespace {

constexpr std::size_t kBlock = 16;
constexpr std::size_t kCountBytes = 2;
static_assert(kBeamsMax <= 0xffff);

constexpr std::size_t kPaddedMax = (kBeamsMax + kBlock - 1) / kBlock * kBlock;

/// The numbers of a block. Its size is fixed, so that the compiler turns each loop below into a few instructions.
using Block = std::span<std::uint32_t, kBlock>;
using ConstBlock = std::span<const std::uint32_t, kBlock>;

constexpr std::uint32_t zigzag(std::uint32_t difference) noexcept {
    return difference << 1 ^ (0U - (difference >> 31));
}
constexpr std::uint32_t unzigzag(std::uint32_t applied) noexcept { return applied >> 1 ^ (0U - (applied & 1)); }

std::uint8_t width_of(ConstBlock block) noexcept {
    std::uint32_t bits = 0;
    for (const std::uint32_t number : block) bits |= number;
    return bits == 0 ? 0 : bits <= 0xff ? 1 : bits <= 0xffff ? 2 : 4;
}

template <class Narrow>
void store(ConstBlock block, char* out) {
    std::array<Narrow, kBlock> narrow;
    for (std::size_t i = 0; i < kBlock; ++i) narrow[i] = static_cast<Narrow>(block[i]);
    for (Narrow& number : narrow) boost::endian::native_to_little_inplace(number);
    std::memcpy(out, narrow.data(), sizeof narrow);
}

void store(ConstBlock block, std::uint8_t width, char* out) {
    if (width == 1) store<std::uint8_t>(block, out);
    if (width == 2) store<std::uint16_t>(block, out);
    if (width == 4) store<std::uint32_t>(block, out);
}

template <class Narrow>
void load(const char* in, Block block) {
    std::array<Narrow, kBlock> narrow;
    std::memcpy(narrow.data(), in, sizeof narrow);
    for (Narrow& number : narrow) boost::endian::little_to_native_inplace(number);
    for (std::size_t i = 0; i < kBlock; ++i) block[i] = unzigzag(narrow[i]);
}

void load(const char* in, std::uint8_t width, Block block) {
    if (width == 0) std::ranges::fill(block, 0U);
    if (width == 1) load<std::uint8_t>(in, block);
    if (width == 2) load<std::uint16_t>(in, block);
    if (width == 4) load<std::uint32_t>(in, block);
}

/// Loads a block near the end of the bytes, which may be shorter than a full block.
void load_last(std::string_view bytes, std::uint8_t width, Block block) {
    std::array<char, kBlock * sizeof(std::uint32_t)> padded{};
    std::memcpy(padded.data(), bytes.data(), std::min(bytes.size(), padded.size()));
    load(padded.data(), width, block);
}

/// Computes the zigzag-encoded differences for whole blocks; after the last range they are 0.
void take_differences(std::span<const RangeMm> ranges, std::span<std::uint32_t> differences) {
    differences[0] = zigzag(ranges[0]);
    for (std::size_t i = 1; i < ranges.size(); ++i) differences[i] = zigzag(ranges[i] - ranges[i - 1]);
    std::ranges::fill(differences.subspan(ranges.size()), 0U);
}

} // namespace

std::string pack_ranges(std::span<const RangeMm> ranges) {
    assert(ranges.size() <= kBeamsMax);
    const std::size_t blocks = (ranges.size() + kBlock - 1) / kBlock;
    std::array<std::uint32_t, kPaddedMax> differences;
    if (!ranges.empty()) take_differences(ranges, std::span(differences).first(blocks * kBlock));
    std::array<char, kCountBytes + kPaddedMax / kBlock + kPaddedMax * sizeof(std::uint32_t)> packed;
    boost::endian::store_little_u16(reinterpret_cast<unsigned char*>(packed.data()),
                                    static_cast<std::uint16_t>(ranges.size()));
    char* out = packed.data() + kCountBytes;
    for (std::size_t begin = 0; begin < ranges.size(); begin += kBlock) {
        const ConstBlock block(differences.data() + begin, kBlock);
        const std::uint8_t width = width_of(block);
        *out++ = static_cast<char>(width);
        store(block, width, out);
        out += std::min(kBlock, ranges.size() - begin) * width;
    }
    return {packed.data(), out};
}

std::optional<std::vector<RangeMm>> unpack_ranges(std::string_view packed) {
    if (packed.size() < kCountBytes) return std::nullopt;
    const std::size_t beams = boost::endian::load_little_u16(reinterpret_cast<const unsigned char*>(packed.data()));
    packed.remove_prefix(kCountBytes);
    if (beams > kBeamsMax) return std::nullopt;
    std::array<std::uint32_t, kPaddedMax> numbers;
    for (std::size_t begin = 0; begin < beams; begin += kBlock) {
        if (packed.empty()) return std::nullopt;
        const auto width = static_cast<std::uint8_t>(packed.front());
        packed.remove_prefix(1);
        const std::size_t bytes = std::min(kBlock, beams - begin) * width;
        if ((width > 2 && width != 4) || packed.size() < bytes) return std::nullopt;
        const Block block(numbers.data() + begin, kBlock);
        if (packed.size() < kBlock * width) {
            load_last(packed, width, block);
        } else {
            load(packed.data(), width, block);
        }
        packed.remove_prefix(bytes);
    }
    if (!packed.empty()) return std::nullopt;
    RangeMm range = 0;
    for (std::size_t i = 0; i < beams; ++i) numbers[i] = range += numbers[i];
    return std::vector<RangeMm>(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(beams));
}

} // namespace scanloom::wire
