#include "common/hash/crc32c.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

#if defined(__x86_64__)
#include <nmmintrin.h>
#endif

namespace scanloom {
namespace {

constexpr std::uint32_t kPolynomial = 0x82F63B78; // Castagnoli's, lowest bit first

/// table[k][b] is what byte b, followed by k zero bytes, contributes to the CRC.
/// Source: Kounavis, Berry, Novel Table Lookup-Based Algorithms for High-Performance CRC Generation (2008), slicing by
///         8.
using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
    Tables tables{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t crc = byte;
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? kPolynomial : 0);
        tables[0][byte] = crc;
    }
    for (std::size_t k = 1; k < tables.size(); ++k) {
        for (std::size_t byte = 0; byte < 256; ++byte) {
            const std::uint32_t before = tables[k - 1][byte];
            tables[k][byte] = before >> 8 ^ tables[0][before & 0xff];
        }
    }
    return tables;
}

constexpr Tables kTables = make_tables();

std::uint32_t by_tables(std::uint32_t crc, std::string_view bytes) {
    if constexpr (std::endian::native == std::endian::little) {
        for (; bytes.size() >= 8; bytes.remove_prefix(8)) {
            std::uint64_t eight = 0;
            std::memcpy(&eight, bytes.data(), sizeof eight);
            eight ^= crc;
            crc = 0;
            for (std::size_t k = 0; k < 8; ++k) crc ^= kTables[7 - k][eight >> (8 * k) & 0xff];
        }
    }
    for (const char byte : bytes) crc = crc >> 8 ^ kTables[0][(crc ^ static_cast<unsigned char>(byte)) & 0xff];
    return crc;
}

#if defined(__x86_64__)
/// Uses the processor's instruction, eight bytes at a time.
[[gnu::target("sse4.2")]] std::uint32_t by_instruction(std::uint32_t crc, std::string_view bytes) {
    std::uint64_t wide = crc;
    for (; bytes.size() >= 8; bytes.remove_prefix(8)) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, bytes.data(), sizeof eight);
        wide = _mm_crc32_u64(wide, eight);
    }
    crc = static_cast<std::uint32_t>(wide);
    for (const char byte : bytes) crc = _mm_crc32_u8(crc, static_cast<unsigned char>(byte));
    return crc;
}

bool has_instruction() {
    static const bool has = __builtin_cpu_supports("sse4.2") != 0;
    return has;
}
#else
std::uint32_t by_instruction(std::uint32_t crc, std::string_view bytes) { return by_tables(crc, bytes); }
bool has_instruction() { return false; }
#endif

} // namespace

std::uint32_t crc32c(std::string_view head, std::string_view tail) {
    const auto extend = has_instruction() ? by_instruction : by_tables;
    return ~extend(extend(~std::uint32_t{0}, head), tail);
}

std::uint32_t crc32c_by_tables(std::string_view bytes) { return ~by_tables(~std::uint32_t{0}, bytes); }

} // namespace scanloom
