#include "robot_client/lidars/ld06_turns.hpp"

#include "common/scan/limits.hpp"
#include "tests/support/ld06_bytes.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing_support::Ld06Spinner;

constexpr std::int32_t kGap = 880; // step between the spinner's points
constexpr double kPacketSeconds = 0.002667;

/// Feeds packets and collects turns; packet n has the stamp n * kPacketSeconds.
struct Cutter {
    Ld06Turns turns;
    std::vector<LidarTurn> complete;
    int packets = 0;

    void add(const Ld06Packet& packet) {
        turns.add(packet, packets++ * kPacketSeconds);
        while (auto turn = turns.next()) complete.push_back(std::move(*turn));
    }
    void add(Ld06Spinner& sensor, int count) {
        for (int i = 0; i < count; ++i) add(sensor.next());
    }
};

void expect_rising(const LidarTurn& turn) {
    ASSERT_FALSE(turn.beams.empty());
    EXPECT_GE(turn.beams.front().step, 0);
    EXPECT_LT(turn.beams.back().step, kLd06StepsPerTurn);
    for (std::size_t i = 1; i < turn.beams.size(); ++i) {
        ASSERT_GT(turn.beams[i].step, turn.beams[i - 1].step) << "beam " << i;
    }
}

TEST(Ld06Turns, AreCutAtAngleZeroWithoutLosingPoints) {
    Ld06Spinner sensor(34'000);
    Cutter cutter;
    cutter.add(sensor, 200); // 2400 points, 25 of them before the first crossing
    ASSERT_EQ(cutter.complete.size(), 5U);
    std::int64_t expected = 0; // step of the first point after the crossing: 34000 + 25 * 80 = 36000
    for (const auto& turn : cutter.complete) {
        EXPECT_EQ(turn.beams.size(), 450U);
        expect_rising(turn);
        for (const auto& beam : turn.beams) {
            ASSERT_EQ(beam.step, expected % kLd06StepsPerTurn) << "each point must appear once and unchanged";
            ASSERT_EQ(beam.point.distance, 1000 + 10 * (beam.step / 1100));
            expected += kGap;
        }
    }
}

TEST(Ld06Turns, KeepVaryingPointCounts) {
    Ld06Spinner sensor(30); // 450 points of 0.8 degrees are a full turn, so every turn begins at 0.3 degrees
    Cutter cutter;
    cutter.add(sensor, 120);
    ASSERT_EQ(cutter.complete.size(), 2U);
    EXPECT_EQ(cutter.complete[0].beams.front().step, 330);

    Ld06Packet packet{.speed = 3600, .start_angle = 0, .end_angle = 913}; // 0.83 degrees: 433.7 points a turn
    Cutter uneven;
    for (int i = 0; i < 400; ++i) {
        packet.start_angle = static_cast<std::uint16_t>(i * 12 * 83 % 36'000);
        packet.end_angle = static_cast<std::uint16_t>((packet.start_angle + 11 * 83) % 36'000);
        packet.timestamp = static_cast<std::uint16_t>(i * 277 / 100);
        uneven.add(packet);
    }
    std::size_t points = 0;
    for (const auto& turn : uneven.complete) {
        expect_rising(turn);
        EXPECT_TRUE(turn.beams.size() == 433 || turn.beams.size() == 434) << turn.beams.size();
        points += turn.beams.size();
    }
    ASSERT_EQ(uneven.complete.size(), 10U);
    EXPECT_EQ(points, (11U * 36'000U) / 83U - 36'000U / 83U) << "all points of eleven turns except the first";
}

TEST(Ld06Turns, IncompleteFirstTurnIsDropped) {
    Ld06Spinner sensor(18'000);
    Cutter cutter;
    cutter.add(sensor, 38);
    EXPECT_TRUE(cutter.complete.empty());
    cutter.add(sensor, 19);
    ASSERT_EQ(cutter.complete.size(), 1U);
    EXPECT_EQ(cutter.complete[0].beams.size(), 450U);
    EXPECT_EQ(cutter.turns.count(), 1U);
}

TEST(Ld06Turns, StampIsTheMiddleOfTheTurn) {
    Ld06Spinner sensor(0);
    Cutter cutter;
    cutter.add(sensor, 76); // packets 0 to 37 are the first turn, 37 to 75 the second
    ASSERT_EQ(cutter.complete.size(), 1U);
    EXPECT_DOUBLE_EQ(cutter.complete[0].stamp, (37 + 74) / 2.0 * kPacketSeconds);
}

TEST(Ld06Turns, DurationIsThatOfTheBeamsAtTheSpeedOfTheSensor) {
    Ld06Spinner sensor(0);
    Cutter cutter;
    cutter.add(sensor, 45);
    sensor.skip(3);
    cutter.add(sensor, 60);
    ASSERT_EQ(cutter.complete.size(), 1U);
    EXPECT_NEAR(cutter.complete[0].duration, 449 * 0.8 / 3600.0, 1e-9) << "with a hole, too";
}

TEST(Ld06Turns, LostPacketsLeaveAGap) {
    Ld06Spinner sensor(0);
    Cutter cutter;
    cutter.add(sensor, 45);
    sensor.skip(3);
    cutter.add(sensor, 60);
    ASSERT_EQ(cutter.complete.size(), 1U);
    expect_rising(cutter.complete[0]);
    EXPECT_EQ(cutter.complete[0].beams.size(), 450U - 36U);
    EXPECT_EQ(cutter.turns.parts() + cutter.turns.gaps(), 0U) << "the turn is complete otherwise";
}

TEST(Ld06Turns, GapAcrossAngleZeroEndsTheTurn) {
    Ld06Spinner sensor(0);
    Cutter cutter;
    cutter.add(sensor, 72);
    sensor.skip(6); // the crossing is at packet 75
    cutter.add(sensor, 40);
    ASSERT_EQ(cutter.complete.size(), 2U);
    EXPECT_EQ(cutter.complete[0].beams.size() + cutter.complete[1].beams.size(), 900U - 72U);
    for (const auto& turn : cutter.complete) expect_rising(turn);
}

TEST(Ld06Turns, DoNotJoinPartsOfDifferentTurns) {
    for (const int lost : {30, 36, 37, 38, 39, 45, 75, 300, 3000}) {
        Ld06Spinner sensor(0);
        Cutter cutter;
        cutter.add(sensor, 50);
        sensor.skip(lost);
        cutter.add(sensor, 80);
        ASSERT_GE(cutter.complete.size(), 3U) << lost;
        for (const auto& turn : cutter.complete) {
            expect_rising(turn);
            EXPECT_LE(turn.beams.size(), 450U);
        }
        // The part of the turn before the lost packets is given.
        EXPECT_EQ(cutter.complete[0].beams.size(), 600U - 450U) << lost;
    }
}

TEST(Ld06Turns, DoNotJoinPartsIfTheSpeedIsInaccurate) {
    Cutter cutter;
    cutter.add({.speed = 3600, .start_angle = 35'900, .end_angle = 35'980, .timestamp = 0});
    cutter.add({.speed = 3600, .start_angle = 200, .end_angle = 1080, .timestamp = 3});
    cutter.add({.speed = 3600, .start_angle = 35'000, .end_angle = 35'880, .timestamp = 104}); // 363.6 degrees
    ASSERT_EQ(cutter.complete.size(), 1U);
    EXPECT_EQ(cutter.complete[0].beams.size(), 12U);
}

TEST(Ld06Turns, DecreasingTimestampEndsATurnOfASlowSensor) {
    Cutter cutter;
    cutter.add({.speed = 10, .start_angle = 35'999, .end_angle = 0, .timestamp = 9'998});
    cutter.add({.speed = 10, .start_angle = 1, .end_angle = 12, .timestamp = 10'000});
    cutter.add({.speed = 10, .start_angle = 24'000, .end_angle = 24'011, .timestamp = 4'000}); // +24 s or -6 s
    EXPECT_EQ(cutter.complete.size(), 1U);
}

TEST(Ld06Turns, DecreasingTimestampEndsATurn) {
    Ld06Spinner sensor(0, 10'000);
    Cutter cutter;
    cutter.add(sensor, 60);
    Ld06Spinner other(20'000, 4'000);
    cutter.add(other, 60);
    ASSERT_EQ(cutter.complete.size(), 3U);
    EXPECT_EQ(cutter.complete[0].beams.size(), 720U - 450U);
    EXPECT_EQ(cutter.complete[1].beams.front().step, 20'000 * 11);
    EXPECT_EQ(cutter.complete[1].beams.size(), 200U);
    EXPECT_EQ(cutter.complete[2].beams.front().step, 0);
    EXPECT_EQ(cutter.turns.count(), 3U);
    EXPECT_EQ(cutter.turns.parts(), 2U) << "the parts before and after the gap";
    EXPECT_EQ(cutter.turns.gaps(), 1U);
}

TEST(Ld06Turns, IncompleteEndsAreNotCountedAsParts) {
    Cutter cutter;
    Ld06Spinner sensor(10'000, 10'000);
    cutter.add(sensor, 5); // of the turn that is dropped
    Ld06Spinner other(10'000, 4'000);
    cutter.add(other, 5); // of a turn that does not end
    EXPECT_EQ(cutter.turns.gaps(), 1U);
    EXPECT_EQ(cutter.turns.parts(), 0U);
    cutter.turns.restart();
    Ld06Spinner again(0);
    cutter.add(again, 80);
    EXPECT_EQ(cutter.turns.count(), 1U);
    EXPECT_EQ(cutter.turns.parts(), 0U);
}

TEST(Ld06Turns, AngleJumpEndsATurn) {
    Ld06Spinner sensor(0);
    Cutter cutter;
    cutter.add(sensor, 60); // at 216 degrees
    Ld06Spinner other(10'000, 160);
    cutter.add(other, 10);
    ASSERT_EQ(cutter.complete.size(), 1U);
    EXPECT_EQ(cutter.complete[0].beams.size(), 270U);
}

TEST(Ld06Turns, PointsWithDecreasingAnglesAreDropped) {
    Ld06Spinner sensor(0);
    Cutter cutter;
    cutter.add(sensor, 45);
    Ld06Packet packet = sensor.next();
    packet.start_angle = static_cast<std::uint16_t>(packet.start_angle - 200);
    packet.end_angle = static_cast<std::uint16_t>(packet.end_angle - 200);
    cutter.add(packet);
    cutter.add(sensor, 60);
    ASSERT_EQ(cutter.complete.size(), 1U);
    expect_rising(cutter.complete[0]);
    EXPECT_EQ(cutter.complete[0].beams.size(), 448U) << "two of the twelve points step back";

    Cutter standing; // the motor is blocked
    Ld06Packet held{.speed = 0, .start_angle = 500, .end_angle = 500};
    for (int i = 0; i < 100; ++i) standing.add(held);
    EXPECT_TRUE(standing.complete.empty());
}

TEST(Ld06Turns, AcceleratingSensorGivesCompleteTurns) {
    Cutter cutter;
    double angle = 0.0; // hundredths of a degree
    for (int i = 0; i < 1000; ++i) {
        const int speed = 600 + 3 * i; // degrees per second
        const double span = speed * 100.0 * kPacketSeconds;
        cutter.add({.speed = static_cast<std::uint16_t>(speed),
                    .start_angle = static_cast<std::uint16_t>(static_cast<int>(angle) % 36'000),
                    .end_angle = static_cast<std::uint16_t>(static_cast<int>(angle + span * 11 / 12) % 36'000),
                    .timestamp = static_cast<std::uint16_t>(i * kPacketSeconds * 1000)});
        angle += span;
    }
    EXPECT_EQ(cutter.complete.size(), static_cast<std::size_t>(angle / 36'000.0) - 1);
    for (const auto& turn : cutter.complete) expect_rising(turn);
    EXPECT_GT(cutter.complete.front().beams.size(), 2 * cutter.complete.back().beams.size());
}

TEST(Ld06Turns, TurnsWithTooManyPointsAreDroppedAndCounted) {
    const auto turn_of = [](std::size_t points) {
        Cutter cutter;
        cutter.add({.speed = 300, .start_angle = 35'990, .end_angle = 35'990});
        std::uint16_t elapsed = 1;
        for (std::size_t point = 0; point < points; point += 12) {
            const auto start = static_cast<std::uint16_t>(point * 36'000 / points);
            const auto end = static_cast<std::uint16_t>(std::min<std::size_t>(start + 66, 35'999));
            cutter.add({.speed = 300, .start_angle = start, .end_angle = end, .timestamp = elapsed});
            elapsed = static_cast<std::uint16_t>(elapsed + 3);
        }
        cutter.add({.speed = 300, .start_angle = 10, .end_angle = 20, .timestamp = elapsed});
        return cutter;
    };
    const auto most = turn_of(4092);
    EXPECT_EQ(most.turns.too_long(), 0U);
    ASSERT_EQ(most.complete.size(), 1U);
    EXPECT_LE(most.complete[0].beams.size(), kBeamsMax);
    const auto more = turn_of(4800);
    EXPECT_EQ(more.turns.too_long(), 1U);
    EXPECT_TRUE(more.complete.empty());
    EXPECT_EQ(more.turns.count(), 0U);
}

TEST(Ld06Turns, RestartDropsTheFirstTurn) {
    Ld06Spinner sensor(0);
    Cutter cutter;
    cutter.add(sensor, 60);
    cutter.turns.restart();
    cutter.add(sensor, 16);
    EXPECT_TRUE(cutter.complete.empty());
    cutter.add(sensor, 40);
    ASSERT_EQ(cutter.complete.size(), 1U);
    EXPECT_EQ(cutter.complete[0].beams.size(), 450U);
}

} // namespace
} // namespace scanloom::robot
