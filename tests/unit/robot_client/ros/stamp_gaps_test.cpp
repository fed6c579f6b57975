#include "robot_client/ros/robot_clock.hpp"
#include "robot_client/ros/stamp_gaps.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

constexpr RosTime kOneSecond = 1'000'000'000;
constexpr RosTime kTenthSecond = kOneSecond / 10;

/// Gaps of a topic that has sent 20 messages, the last one at 1.9 s.
StampGaps regular() {
    StampGaps gaps;
    for (RosTime n = 0; n < 20; ++n) EXPECT_EQ(gaps.add(n * kTenthSecond + n % 3 * 1'000'000), 0U) << "jitter";
    return gaps;
}

TEST(StampGaps, CountsMessagesBetweenTwoStamps) {
    StampGaps gaps = regular();
    EXPECT_EQ(gaps.add(24 * kTenthSecond), 4U);
    EXPECT_EQ(gaps.add(25 * kTenthSecond), 0U);
    EXPECT_EQ(gaps.add(27 * kTenthSecond), 1U);
    EXPECT_EQ(gaps.missing(), 5U);
    EXPECT_EQ(gaps.gaps(), 2U);
}

TEST(StampGaps, PausesAndClocksThatAreSetAreNoGaps) {
    StampGaps gaps = regular();
    EXPECT_EQ(gaps.add(19 * kTenthSecond + 11 * kOneSecond), 0U);
    EXPECT_EQ(gaps.add(0), 0U);
    EXPECT_EQ(gaps.add(1), 0U);
    gaps.restart();
    EXPECT_EQ(gaps.add(5 * kOneSecond), 0U);
}

TEST(StampGaps, ANewRateIsNoLongerAGapAfterSomeTime) {
    StampGaps gaps = regular();
    RosTime stamp = 19 * kTenthSecond;
    for (int n = 0; n < 30; ++n) static_cast<void>(gaps.add(stamp += 2 * kTenthSecond));
    EXPECT_EQ(gaps.gaps(), 7U);
}

TEST(StampGaps, FewIntervalsShowNothing) {
    StampGaps gaps;
    for (const RosTime stamp : {0, 1, 5, 6, 20}) EXPECT_EQ(gaps.add(stamp * kTenthSecond), 0U);
}

TEST(RobotClock, AgreesWithThisMachinesIfStampsAreALittleOld) {
    RobotClock clock;
    EXPECT_EQ(clock.now(7), 7);
    constexpr RosTime kNow = 1'600'000'000 * kOneSecond;
    clock.add(kNow - kTenthSecond, kNow);
    EXPECT_EQ(clock.now(kNow + kTenthSecond), kNow + kTenthSecond);
}

TEST(RobotClock, FollowsASimulationYearsOff) {
    RobotClock clock;
    constexpr RosTime kNow = 1'600'000'000 * kOneSecond;
    clock.add(10 * kOneSecond - 3, kNow);
    clock.add(10 * kOneSecond + kTenthSecond - 1, kNow + kTenthSecond);
    EXPECT_EQ(clock.now(kNow + 2 * kTenthSecond), 10 * kOneSecond + 2 * kTenthSecond - 1)
        << "by the message with the least delay";
}

/// A message cannot come before its stamp, and seldom a quarter of a second after it.
TEST(RobotClock, FollowsClocksThatAreALittleOff) {
    constexpr RosTime kNow = 1'600'000'000 * kOneSecond;
    for (const RosTime off : {RosTime{1'000'000}, 8 * kTenthSecond, -3 * kTenthSecond, -8 * kTenthSecond}) {
        RobotClock clock;
        clock.add(kNow + off, kNow);
        EXPECT_EQ(clock.now(kNow + kTenthSecond), kNow + kTenthSecond + off);
    }
}

TEST(RobotClock, StaysNearTheStampsOfASimulationThatIsSlowOrPaused) {
    RobotClock clock;
    constexpr RosTime kNow = 1'600'000'000 * kOneSecond;
    for (RosTime n = 0; n <= 30; ++n) { // at half the speed
        clock.add(n * kTenthSecond / 2, kNow + n * kTenthSecond);
        EXPECT_LE(clock.now(kNow + n * kTenthSecond), n * kTenthSecond / 2 + 2 * kTenthSecond);
    }
    EXPECT_EQ(clock.now(kNow + 60 * kOneSecond), 15 * kTenthSecond + 2 * kTenthSecond) << "paused";
    clock.add(16 * kTenthSecond, kNow + 61 * kOneSecond);
    EXPECT_LE(clock.now(kNow + 61 * kOneSecond), 18 * kTenthSecond) << "resumed";
}

TEST(RobotClock, FollowsAClockThatWasSetBackWithinSomeSeconds) {
    RobotClock clock;
    constexpr RosTime kNow = 1'600'000'000 * kOneSecond;
    clock.add(100 * kOneSecond, kNow);
    for (RosTime n = 1; n < 13; ++n) clock.add(n * kOneSecond, kNow + n * kOneSecond);
    EXPECT_EQ(clock.now(kNow + 12 * kOneSecond), 12 * kOneSecond);
}

TEST(RisingStamps, NoneComesTwiceAndNoneDecreasesUnlessTheClockWasSet) {
    RisingStamps stamps;
    EXPECT_EQ(stamps.next(5 * kOneSecond), 5 * kOneSecond);
    EXPECT_EQ(stamps.next(5 * kOneSecond), 5 * kOneSecond + 1);
    EXPECT_EQ(stamps.next(4 * kOneSecond + 1), 5 * kOneSecond + 2);
    EXPECT_EQ(stamps.next(6 * kOneSecond), 6 * kOneSecond);
    EXPECT_EQ(stamps.next(1 * kOneSecond), 1 * kOneSecond);
}

} // namespace
} // namespace scanloom::robot
