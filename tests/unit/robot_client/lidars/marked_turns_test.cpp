#include "robot_client/lidars/marked_turns.hpp"

#include "common/scan/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;

constexpr std::int32_t kSteps = 360;

/// Adds a turn of `points` points, and its mark.
void add_turn(MarkedTurns& turns, double arrival, int points = kSteps) {
    turns.begin_turn(arrival);
    for (int i = 0; i < points; ++i) turns.add({i * kSteps / points, {1000, 10}});
}

TEST(MarkedTurns, AreGivenBetweenTwoMarks) {
    MarkedTurns turns(kSteps);
    turns.add({350, {1, 0}}); // of a turn whose beginning was not seen
    add_turn(turns, 10.0);
    EXPECT_FALSE(turns.next());
    add_turn(turns, 10.1);
    const auto turn = turns.next().value();
    EXPECT_EQ(turn.beams.size(), 360U);
    EXPECT_NEAR(turn.duration, 0.1 * 359 / 360, 1e-9);
    EXPECT_NEAR(turn.stamp, 10.05, 1e-9) << "its middle";
    EXPECT_FALSE(turns.next());
    EXPECT_EQ(turns.count(), 1U);
}

TEST(MarkedTurns, AreSortedAndHaveEachDirectionOnce) {
    MarkedTurns turns(kSteps);
    turns.begin_turn(1.0);
    for (const std::int32_t step : {355, 2, 1, 90, 91, 90, 200, 300}) {
        turns.add({step, {static_cast<std::uint16_t>(step + 1), 0}});
    }
    turns.begin_turn(1.1);
    std::vector<std::int32_t> steps;
    const auto turn = turns.next().value();
    for (const auto& beam : turn.beams) steps.push_back(beam.step);
    EXPECT_THAT(steps, ElementsAre(1, 2, 90, 91, 200, 300, 355));
}

TEST(MarkedTurns, ALostMarkDropsTheTurns) {
    MarkedTurns turns(kSteps);
    add_turn(turns, 1.0);
    for (int i = 0; i < kSteps; ++i) turns.add({i, {2000, 10}}); // without its mark
    turns.begin_turn(1.2);
    EXPECT_FALSE(turns.next());
    EXPECT_EQ(turns.gaps(), 1U);
    for (int i = 0; i < kSteps; i += 2) turns.add({i, {1000, 10}}); // half of the points are missing
    turns.begin_turn(1.3);
    EXPECT_EQ(turns.next()->beams.size(), 180U);
}

TEST(MarkedTurns, TooManyPointsAreDropped) {
    MarkedTurns turns(1 << 20);
    turns.begin_turn(1.0);
    for (std::size_t i = 0; i <= kBeamsMax; ++i) turns.add({static_cast<std::int32_t>(i), {1, 0}});
    turns.begin_turn(1.1);
    EXPECT_FALSE(turns.next());
    EXPECT_EQ(turns.too_long(), 1U);
}

TEST(MarkedTurns, RestartForgetsTheCurrentTurn) {
    MarkedTurns turns(kSteps);
    add_turn(turns, 1.0);
    turns.restart();
    turns.begin_turn(1.1);
    EXPECT_FALSE(turns.next());
}

TEST(TurnClock, SmoothesLateMarks) {
    std::mt19937 random(1);
    TurnClock clock;
    double sum = 0.0; // of the errors
    for (int turn = 0; turn < 1000; ++turn) {
        const double began = 1000.0 + turn * 0.1;
        clock.begin_turn(began + 0.001 * static_cast<double>(random() % 16));
        if (turn < 8) continue;
        sum += std::abs(clock.begun() - began);
        EXPECT_NEAR(clock.period().value(), 0.1, 0.003);
    }
    EXPECT_LT(sum / 992, 0.0035) << "marks are 7.5 ms late on average";
}

TEST(TurnClock, StartsAgainAfterAGap) {
    TurnClock clock;
    EXPECT_EQ(clock.period(), std::nullopt);
    for (const double arrival : {1.0, 1.1, 1.2}) clock.begin_turn(arrival);
    EXPECT_NEAR(clock.period().value(), 0.1, 1e-9);
    clock.begin_turn(1.4); // a mark was lost
    EXPECT_EQ(clock.period(), std::nullopt);
    EXPECT_EQ(clock.begun(), 1.4);
    clock.begin_turn(0.9); // the clock was set back
    EXPECT_EQ(clock.begun(), 0.9);
    clock.begin_turn(0.9); // two marks at once
    EXPECT_EQ(clock.period(), std::nullopt);
}

} // namespace
} // namespace scanloom::robot
