#include "robot_client/ros/stamp_epochs.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace scanloom::robot {
namespace {

constexpr RosTime kOne = 1'000'000'000; // second

/// A robot's messages: topic 0 has scans, topic 1 transforms of two frames.
class StampEpochsTest : public testing::Test {
protected:
    std::uint32_t scan(RosTime seconds) { return epochs_.of(0, {}, seconds * kOne); }
    std::uint32_t base(RosTime seconds) { return epochs_.of(1, "base", seconds * kOne); }
    std::uint32_t arm(RosTime seconds) { return epochs_.of(1, "arm", seconds * kOne); }

    /// All streams from one second to another.
    void expect_all(RosTime from, RosTime to, std::uint32_t epoch) {
        for (RosTime second = from; second <= to; ++second) {
            EXPECT_EQ(base(second), epoch) << second;
            EXPECT_EQ(arm(second), epoch) << second;
            EXPECT_EQ(scan(second), epoch) << second;
        }
    }

    StampEpochs epochs_;
};

TEST_F(StampEpochsTest, AllStreamsJoinTheEpochThatTheFirstOneBegins) {
    expect_all(100, 140, 0);
    EXPECT_EQ(base(100), 1U);
    EXPECT_EQ(scan(141), 0U) << "a late message of the time before";
    expect_all(101, 190, 1);
    EXPECT_EQ(scan(98), 2U);
    expect_all(99, 101, 2);
}

TEST_F(StampEpochsTest, JitterAndPausesBeginNone) {
    expect_all(100, 110, 0);
    EXPECT_EQ(scan(108), 0U);
    expect_all(111, 112, 0);
    expect_all(5'000, 5'010, 0);
}

TEST_F(StampEpochsTest, AStreamReturnsAfterAWrongStamp) {
    expect_all(100, 110, 0);
    EXPECT_EQ(scan(50), 1U);
    expect_all(111, 120, 0);
    for (const RosTime late : {100'000, 125, 128}) {
        EXPECT_EQ(scan(late), 0U);
        expect_all(121, 122, 0);
    }
    expect_all(123, 130, 0);
    EXPECT_EQ(scan(60), 1U) << "again";
    expect_all(131, 140, 0);
    EXPECT_EQ(base(100), 1U) << "the clock is set back";
    expect_all(101, 110, 1);
}

TEST_F(StampEpochsTest, APauseWhereTheClockWasSetBackEndsNoEpoch) {
    expect_all(100, 140, 0);
    expect_all(110, 137, 1);
    expect_all(141, 150, 1);
}

TEST_F(StampEpochsTest, AnyStampsAreTaken) {
    for (const RosTime stamp : {std::numeric_limits<RosTime>::max(), std::numeric_limits<RosTime>::min(), RosTime{0},
                                std::numeric_limits<RosTime>::max()}) {
        EXPECT_LE(epochs_.of(0, {}, stamp), 1U);
    }
}

} // namespace
} // namespace scanloom::robot
