#include "common/hash/crc32c.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>

namespace scanloom {
namespace {

/// Computes the CRC bit by bit.
/// Source  RFC 3720, B.4.
std::uint32_t crc32c_bit_by_bit(std::string_view bytes) {
    std::uint32_t crc = 0xFFFFFFFF;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0x82F63B78U : crc >> 1;
    }
    return ~crc;
}

TEST(Crc32c, IsIndependentOfImplementationAlignmentAndSplits) {
    std::mt19937 random(5);
    std::string bytes(200, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    for (std::size_t size = 0; size <= bytes.size(); ++size) {
        const auto part = std::string_view(bytes).substr(bytes.size() - size); // at every alignment
        const auto expected = crc32c_bit_by_bit(part);
        EXPECT_EQ(crc32c_by_tables(part), expected) << size;
        EXPECT_EQ(crc32c(part.substr(0, size / 3), part.substr(size / 3)), expected) << size;
    }
}

} // namespace
} // namespace scanloom
