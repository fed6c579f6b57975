#include "robot_client/lidars/rplidar_packet.hpp"

#include "tests/support/lidar_emulators.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using Bytes = std::vector<std::uint8_t>;

std::vector<RplidarPoint> points_in(RplidarDecoder& decoder, const Bytes& bytes) {
    std::vector<RplidarPoint> points;
    decoder.feed(bytes);
    while (const auto point = decoder.next()) points.push_back(*point);
    return points;
}

/// Turns of an emulated sensor.
Bytes turns_of(bool is_express, int turns) {
    testing_support::RplidarEmulator emulator({.firmware_minor = 29});
    const Bytes start = is_express ? Bytes{0xA5, 0x82, 5, 0, 0, 0, 0, 0, 0x22} : Bytes{0xA5, 0x20};
    (void)emulator.receive(start);
    Bytes bytes;
    for (int i = 0; i < turns; ++i) {
        const auto turn = emulator.next_turn();
        bytes.insert(bytes.end(), turn.begin(), turn.end());
    }
    return bytes;
}

TEST(RplidarNode, HasAngleDistanceAndQuality) {
    // 90.5 degrees, 1234.25 mm, quality 15, start of a turn
    const std::array<std::uint8_t, 5> bytes{15U << 2 | 1U, 0x41, 0x2D, 0x49, 0x13};
    const auto point = read_rplidar_node(bytes).value();
    EXPECT_TRUE(point.starts_turn);
    EXPECT_EQ(point.step, 0x2D41 >> 1);
    EXPECT_EQ(point.step / 64.0, 90.5);
    EXPECT_EQ(point.distance / 4.0, 1234.25);
    EXPECT_EQ(point.quality, 15);
}

TEST(RplidarNode, WrongCheckBitsAndAnglesAreRefused) {
    const std::array<std::uint8_t, 5> good{2, 1, 0, 0, 0};
    EXPECT_TRUE(read_rplidar_node(good));
    auto wrong = good;
    wrong[0] = 3; // starts and does not start a turn
    EXPECT_FALSE(read_rplidar_node(wrong));
    wrong[0] = 0;
    EXPECT_FALSE(read_rplidar_node(wrong));
    wrong = good;
    wrong[1] = 0;
    EXPECT_FALSE(read_rplidar_node(wrong));
    wrong = {2, 0x03, 0xB4, 0, 0}; // 360 + 1/64 degrees
    EXPECT_FALSE(read_rplidar_node(wrong));
    EXPECT_EQ(read_rplidar_node(std::array<std::uint8_t, 5>{2, 0x01, 0xB4, 0, 0})->step, 0) << "360 degrees are 0";
}

TEST(RplidarCapsule, HasDistancesAndOffsets) {
    const auto bytes = turns_of(true, 1);
    const auto first = read_rplidar_capsule(std::span(bytes).first<kRplidarCapsuleBytes>()).value();
    EXPECT_TRUE(first.is_first);
    EXPECT_EQ(first.start, 0);
    EXPECT_EQ(first.points[0], (RplidarCapsule::Point{4000, 8}));
    EXPECT_EQ(first.points[1], (RplidarCapsule::Point{4000, 16})) << "the high bits of an offset are in the distance";
    const auto second = read_rplidar_capsule(std::span(bytes).subspan<84, 84>()).value();
    EXPECT_FALSE(second.is_first);
    EXPECT_EQ(second.start, 30 * 64);
    for (std::size_t at = 0; at < kRplidarCapsuleBytes; ++at) {
        Bytes damaged(bytes.begin(), bytes.begin() + 84);
        damaged[at] ^= 0x10U;
        EXPECT_FALSE(read_rplidar_capsule(std::span(damaged).first<kRplidarCapsuleBytes>())) << at;
    }
}

TEST(RplidarCapsule, PointsAreSpreadUntilTheNextCapsule) {
    RplidarCapsule capsule;
    capsule.start = 350 * 64;
    capsule.points.fill({8000, 0});
    capsule.points[4].offset = 12; // 1.5 degrees
    RplidarCapsule next;
    next.start = 22 * 64;
    std::optional<std::int32_t> angle = 349 * 64;
    const auto points = points_of(capsule, next, angle);
    EXPECT_EQ(points[0].step, 350 * 64);
    EXPECT_EQ(points[3].step, 353 * 64);
    EXPECT_EQ(points[4].step, 352 * 64 + 32) << "354 less 1.5 degrees";
    EXPECT_EQ(points[31].step, 21 * 64);
    EXPECT_EQ(angle, 21 * 64);
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].starts_turn, i == 10) << i;
}

class RplidarStream : public testing::TestWithParam<bool> {
protected:
    [[nodiscard]] static bool is_express() { return GetParam(); }
};

TEST_P(RplidarStream, AnySplitOfTheBytesYieldsTheSamePoints) {
    const auto bytes = turns_of(is_express(), 2);
    RplidarDecoder whole(is_express());
    const auto points = points_in(whole, bytes);
    EXPECT_EQ(points.size(), is_express() ? 23U * 32U : 720U);
    for (const std::size_t piece : {1U, 3U, 83U, 84U, 100U}) {
        RplidarDecoder decoder(is_express());
        std::vector<RplidarPoint> pieces;
        for (std::size_t at = 0; at < bytes.size(); at += piece) {
            const auto end = std::min(at + piece, bytes.size());
            const auto more = points_in(decoder, Bytes(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                                       bytes.begin() + static_cast<std::ptrdiff_t>(end)));
            pieces.insert(pieces.end(), more.begin(), more.end());
        }
        EXPECT_EQ(pieces, points) << piece;
    }
}

TEST_P(RplidarStream, EachTurnIsMarkedOnce) {
    RplidarDecoder decoder(is_express());
    int marks = 0;
    for (const auto& point : points_in(decoder, turns_of(is_express(), 5))) marks += point.starts_turn ? 1 : 0;
    EXPECT_EQ(marks, is_express() ? 4 : 5) << "nothing comes before the first capsule";
}

TEST_P(RplidarStream, LostBytesCostAFewPoints) {
    const auto good = turns_of(is_express(), 3);
    RplidarDecoder reference(is_express());
    const auto expected = points_in(reference, good);
    for (std::size_t lost = 1; lost < 12; ++lost) {
        auto bytes = good;
        bytes.erase(bytes.begin() + 1000, bytes.begin() + 1000 + static_cast<std::ptrdiff_t>(lost));
        RplidarDecoder decoder(is_express());
        const auto points = points_in(decoder, bytes);
        EXPECT_GE(points.size() + (is_express() ? 96 : 8), expected.size()) << lost;
        EXPECT_TRUE(std::equal(points.end() - 300, points.end(), expected.end() - 300)) << lost;
        if (lost % 5 != 0 || is_express()) {
            EXPECT_EQ(decoder.damaged(), 1U) << lost;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Each, RplidarStream, testing::Bool(),
                         [](const auto& each) { return each.param ? "Capsules" : "Nodes"; });

} // namespace
} // namespace scanloom::robot
