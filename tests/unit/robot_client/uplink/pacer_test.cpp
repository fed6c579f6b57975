#include "robot_client/uplink/pacer.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
constexpr Pacer::Time kStart{1000s};

TEST(Pacer, SpeedZeroIsAtOnce) {
    Pacer pacer(0.0);
    EXPECT_EQ(pacer.due(5.0, kStart), kStart);
    EXPECT_EQ(pacer.due(500.0, kStart), kStart);
}

TEST(Pacer, KeepsThePaceOfTheStampsFromTheFirstOn) {
    Pacer pacer(2.0);
    EXPECT_EQ(pacer.due(976052857.0, kStart), kStart);
    EXPECT_EQ(pacer.due(976052858.0, kStart + 10s), kStart + 500ms) << "late scans do not shift those after them";
    EXPECT_EQ(pacer.due(976052867.0, kStart + 10s), kStart + 5s);
}

TEST(Pacer, AStampThatGoesBackIsDueAtOnceAndShiftsNoneAfterIt) {
    Pacer pacer(1.0);
    EXPECT_EQ(pacer.due(100.0, kStart), kStart);
    EXPECT_LT(pacer.due(99.2, kStart + 1s), kStart + 1s);
    EXPECT_EQ(pacer.due(103.0, kStart + 1s), kStart + 3s);
    EXPECT_LT(pacer.due(102.5, kStart + 3s), kStart + 3s);
    EXPECT_EQ(pacer.due(104.0, kStart + 3s), kStart + 4s);
}

TEST(Pacer, APauseCountsAsTenMinutesAtMostAndThePaceGoesOnBehindIt) {
    Pacer pacer(2.0);
    EXPECT_EQ(pacer.due(0.0, kStart), kStart);
    EXPECT_EQ(pacer.due(600.0, kStart), kStart + 5min);
    EXPECT_EQ(pacer.due(1e9, kStart), kStart + 10min);
    EXPECT_EQ(pacer.due(1e9 + 1.0, kStart), kStart + 10min + 500ms);
    EXPECT_EQ(pacer.due(1e300, kStart), kStart + 15min + 500ms);
}

TEST(Pacer, AStepBackCostsNoTime) {
    Pacer pacer(1.0);
    EXPECT_EQ(pacer.due(1e9, kStart), kStart);
    EXPECT_EQ(pacer.due(0.0, kStart), kStart);
    EXPECT_EQ(pacer.due(1.0, kStart), kStart + 1s);
}

TEST(Pacer, NoWaitIsBeyondTheClock) {
    constexpr auto kLargest = std::chrono::duration_cast<Pacer::Time::duration>(1s * Pacer::kWaitMax);
    Pacer slow(1e-300);
    EXPECT_EQ(slow.due(-1e308, kStart), kStart);
    EXPECT_EQ(slow.due(1e308, kStart), kStart + kLargest) << "a gap that no double can hold";
}

} // namespace
} // namespace scanloom::robot
