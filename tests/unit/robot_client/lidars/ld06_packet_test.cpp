#include "robot_client/lidars/ld06_packet.hpp"

#include "tests/support/ld06_bytes.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace scanloom::robot {
namespace {

using testing_support::bytes_of;

struct Vector {
    std::array<std::uint8_t, kLd06PacketBytes> bytes;
    Ld06Packet packet;
};

const Vector kVectors[] = {
    // from the sensor's manual
    {{0x54, 0x2C, 0x68, 0x08, 0xAB, 0x7E, 0xE0, 0x00, 0xE4, 0xDC, 0x00, 0xE2, 0xD9, 0x00, 0xE5, 0xD5,
      0x00, 0xE3, 0xD3, 0x00, 0xE4, 0xD0, 0x00, 0xE9, 0xCD, 0x00, 0xE4, 0xCA, 0x00, 0xE2, 0xC7, 0x00,
      0xE9, 0xC5, 0x00, 0xE5, 0xC2, 0x00, 0xE5, 0xC0, 0x00, 0xE5, 0xBE, 0x82, 0x3A, 0x1A, 0x50},
     {2152,
      32427,
      {{{224, 228},
        {220, 226},
        {217, 229},
        {213, 227},
        {211, 228},
        {208, 233},
        {205, 228},
        {202, 226},
        {199, 233},
        {197, 229},
        {194, 229},
        {192, 229}}},
      33470,
      6714}},
    // an LD19 in front of a wall
    {{0x54, 0x2c, 0xee, 0x0d, 0x48, 0x84, 0xfc, 0x06, 0xad, 0xf3, 0x06, 0xad, 0xeb, 0x06, 0xaf, 0xe3,
      0x06, 0xaf, 0xdc, 0x06, 0xb0, 0xd5, 0x06, 0xb1, 0xce, 0x06, 0xb2, 0xc8, 0x06, 0xb3, 0xc1, 0x06,
      0xb4, 0xbb, 0x06, 0xb5, 0xb6, 0x06, 0xb6, 0xb1, 0x06, 0xb8, 0x55, 0x87, 0xdd, 0x4a, 0x0f},
     {3566,
      33864,
      {{{1788, 173},
        {1779, 173},
        {1771, 175},
        {1763, 175},
        {1756, 176},
        {1749, 177},
        {1742, 178},
        {1736, 179},
        {1729, 180},
        {1723, 181},
        {1718, 182},
        {1713, 184}}},
      34645,
      19165}},
    // no near object, but with confidence
    {{0x54, 0x2C, 0x74, 0x08, 0xB0, 0x86, 0x00, 0x00, 0xD4, 0x00, 0x00, 0xD4, 0x00, 0x00, 0xD4, 0x00,
      0x00, 0xD4, 0x00, 0x00, 0xD4, 0x00, 0x00, 0xD5, 0x00, 0x00, 0xD5, 0x00, 0x00, 0x49, 0x00, 0x00,
      0x5F, 0x00, 0x00, 0xB0, 0x00, 0x00, 0xD2, 0x00, 0x00, 0xD4, 0x02, 0x89, 0x1E, 0x09, 0x1F},
     {2164,
      34480,
      {{{0, 0xD4},
        {0, 0xD4},
        {0, 0xD4},
        {0, 0xD4},
        {0, 0xD4},
        {0, 0xD5},
        {0, 0xD5},
        {0, 0x49},
        {0, 0x5F},
        {0, 0xB0},
        {0, 0xD2},
        {0, 0xD4}}},
      35074,
      2334}},
};

TEST(Ld06Packet, ReadsTheKnownVectors) {
    for (const auto& [bytes, packet] : kVectors) {
        EXPECT_EQ(ld06_crc(bytes), 0);
        EXPECT_EQ(ld06_crc(std::span(bytes).first(46)), bytes[46]);
        EXPECT_EQ(read_ld06_packet(bytes), packet);
        EXPECT_TRUE(is_plausible(packet));
        EXPECT_EQ(bytes_of(packet), std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    }
}

TEST(Ld06Packet, SpanIsClockwiseFromStartToEnd) {
    EXPECT_EQ(steps_spanned({.start_angle = 100, .end_angle = 980}), 880 * 11);
    EXPECT_EQ(steps_spanned({.start_angle = 35'900, .end_angle = 100}), 200 * 11);
    EXPECT_EQ(steps_spanned({.start_angle = 5, .end_angle = 5}), 0);
}

TEST(Ld06Packet, RejectsImplausiblePackets) {
    const Ld06Packet good{.speed = 3600, .start_angle = 0, .end_angle = 2800, .timestamp = 29'999};
    EXPECT_TRUE(is_plausible(good));
    for (const auto& invalidate : std::initializer_list<void (*)(Ld06Packet&)>{
             [](Ld06Packet& p) { p.end_angle = 2900; }, [](Ld06Packet& p) { p.start_angle = 36'001; },
             [](Ld06Packet& p) { p.end_angle = 36'001; }, [](Ld06Packet& p) { p.timestamp = 30'001; },
             [](Ld06Packet& p) { p.speed = 100; }}) {
        Ld06Packet bad = good;
        invalidate(bad);
        EXPECT_FALSE(is_plausible(bad));
    }
    EXPECT_TRUE(is_plausible({.speed = 0, .start_angle = 50, .end_angle = 99})) << "a stopped motor";
}

} // namespace
} // namespace scanloom::robot
