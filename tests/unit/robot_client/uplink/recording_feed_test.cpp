#include "robot_client/uplink/recording_feed.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
constexpr Pacer::Time kPacerStart{1000s};

TEST(Pacer, SpeedZeroDoesNotWait) {
    Pacer pacer(0.0);
    EXPECT_EQ(pacer.due(5.0, kPacerStart), kPacerStart);
    EXPECT_EQ(pacer.due(500.0, kPacerStart), kPacerStart);
}

TEST(Pacer, KeepsThePaceOfTheStamps) {
    Pacer pacer(2.0);
    EXPECT_EQ(pacer.due(976052857.0, kPacerStart), kPacerStart);
    EXPECT_EQ(pacer.due(976052858.0, kPacerStart + 10s), kPacerStart + 500ms)
        << "late scans do not shift those after them";
    EXPECT_EQ(pacer.due(976052867.0, kPacerStart + 10s), kPacerStart + 5s);
}

TEST(Pacer, EarlierStampIsDueAtOnceAndShiftsNoOther) {
    Pacer pacer(1.0);
    EXPECT_EQ(pacer.due(100.0, kPacerStart), kPacerStart);
    EXPECT_LT(pacer.due(99.2, kPacerStart + 1s), kPacerStart + 1s);
    EXPECT_EQ(pacer.due(103.0, kPacerStart + 1s), kPacerStart + 3s);
    EXPECT_LT(pacer.due(102.5, kPacerStart + 3s), kPacerStart + 3s);
    EXPECT_EQ(pacer.due(104.0, kPacerStart + 3s), kPacerStart + 4s);
}

TEST(Pacer, PauseIsCutToTenMinutes) {
    Pacer pacer(2.0);
    EXPECT_EQ(pacer.due(0.0, kPacerStart), kPacerStart);
    EXPECT_EQ(pacer.due(600.0, kPacerStart), kPacerStart + 5min);
    EXPECT_EQ(pacer.due(1e9, kPacerStart), kPacerStart + 10min);
    EXPECT_EQ(pacer.due(1e9 + 1.0, kPacerStart), kPacerStart + 10min + 500ms);
    EXPECT_EQ(pacer.due(1e300, kPacerStart), kPacerStart + 15min + 500ms);
}

TEST(Pacer, StepBackAddsNoTime) {
    Pacer pacer(1.0);
    EXPECT_EQ(pacer.due(1e9, kPacerStart), kPacerStart);
    EXPECT_EQ(pacer.due(0.0, kPacerStart), kPacerStart);
    EXPECT_EQ(pacer.due(1.0, kPacerStart), kPacerStart + 1s);
}

TEST(Pacer, WaitDoesNotOverflowTheClock) {
    constexpr auto kLargest = std::chrono::duration_cast<Pacer::Time::duration>(1s * Pacer::kWaitMax);
    Pacer slow(1e-300);
    EXPECT_EQ(slow.due(-1e308, kPacerStart), kPacerStart);
    EXPECT_EQ(slow.due(1e308, kPacerStart), kPacerStart + kLargest) << "a gap that no double can hold";
}

} // namespace
} // namespace scanloom::robot
