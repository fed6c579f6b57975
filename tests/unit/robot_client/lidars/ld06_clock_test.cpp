#include "robot_client/lidars/ld06_turns.hpp"
#include "robot_client/lidars/lidar_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace scanloom::robot {
namespace {

TEST(Ld06RecordingClock, CountsFromTheFirstPacketAcrossWraps) {
    Ld06RecordingClock clock;
    for (int ms = 0; ms < 100'000; ms += 7) {
        EXPECT_DOUBLE_EQ(clock.stamp(static_cast<std::uint16_t>((29'000 + ms) % 30'000)), ms * 1e-3);
    }
}

TEST(Ld06RecordingClock, AcceptsGapsShorterThanHalfAWrap) {
    Ld06RecordingClock clock;
    EXPECT_EQ(clock.stamp(20'000), 0.0);
    EXPECT_DOUBLE_EQ(clock.stamp(4'999), 14.999) << "across the wrap";
    EXPECT_DOUBLE_EQ(clock.stamp(6'000), 16.0);
}

TEST(Ld06RecordingClock, IsMonotonic) {
    Ld06RecordingClock clock;
    EXPECT_EQ(clock.stamp(26'755), 0.0);
    EXPECT_EQ(clock.stamp(21'038), 0.0) << "another recording begins here";
    EXPECT_DOUBLE_EQ(clock.stamp(21'041), 0.003);
}

TEST(Ld06RecordingClock, LastMillisecondOfAWrapPrecedesTheNextWrap) {
    Ld06RecordingClock clock;
    EXPECT_EQ(clock.stamp(29'999), 0.0);
    EXPECT_DOUBLE_EQ(clock.stamp(30'000), 0.001);
    EXPECT_DOUBLE_EQ(clock.stamp(1), 0.002);
}

/// A sensor whose clock started at Unix time `began` and is too fast by `drift`.
struct Clocked {
    double began = 1.7e9;
    double drift = 0.0;

    [[nodiscard]] std::uint16_t at(double unix_time) const {
        return static_cast<std::uint16_t>(std::fmod((unix_time - began) * (1.0 + drift) * 1000.0, 30'000.0));
    }
};

TEST(LidarClock, StampsAreIndependentOfArrivalJitter) {
    std::mt19937 random(1);
    const Clocked sensor{1.7e9, 1e-4};
    LidarClock clock(kLd06ClockWrap);
    double worst = 0.0;
    double arrival = 0.0;
    for (int i = 0; i < 60'000; ++i) {
        const double taken = sensor.began + 1000.0 + i * 0.01;
        const double late = random() % 50 == 0 ? 0.001 : 0.001 * static_cast<double>(1 + random() % 15);
        arrival = std::max(arrival, taken + late);
        const double error = clock.stamp(sensor.at(taken), arrival) - taken;
        if (i > 500) worst = std::max(worst, std::abs(error - 0.001));
    }
    EXPECT_LT(worst, 0.004)
        << "the error beyond the minimum delay of 1 ms consists of whole milliseconds and 10 s of drift";
}

TEST(LidarClock, ArrivalTimeDeterminesTheWrap) {
    const Clocked sensor;
    LidarClock clock(kLd06ClockWrap);
    double taken = sensor.began + 3.0;
    for (const double lost : {0.0, 14.0, 16.0, 30.0, 59.9, 3600.5}) {
        taken += lost;
        EXPECT_NEAR(clock.stamp(sensor.at(taken), taken + 0.002), taken, 0.004) << lost;
    }
}

TEST(LidarClock, DelayedBytesGetTheirMeasurementTime) {
    const Clocked sensor;
    LidarClock clock(kLd06ClockWrap);
    const double begin = sensor.began + 5.0;
    EXPECT_NEAR(clock.stamp(sensor.at(begin), begin), begin, 0.002);
    for (double taken = begin; taken < begin + 0.8; taken += 0.01) {
        EXPECT_NEAR(clock.stamp(sensor.at(taken), begin + 0.8), taken, 0.002) << "all bytes arrive at the same time";
    }
}

TEST(LidarClock, FollowsStepsOfEitherClock) {
    Clocked sensor;
    LidarClock clock(kLd06ClockWrap);
    double now = sensor.began + 5.0;
    EXPECT_NEAR(clock.stamp(sensor.at(now), now), now, 0.002);
    sensor.began += 7.0; // the sensor was restarted
    now += 8.0;
    EXPECT_NEAR(clock.stamp(sensor.at(now), now), now, 0.002);
    sensor.began += 3600.0; // Unix time was set forward and back
    now += 3600.0;
    EXPECT_NEAR(clock.stamp(sensor.at(now), now), now, 0.002);
    sensor.began -= 3605.0;
    now -= 3605.0;
    EXPECT_NEAR(clock.stamp(sensor.at(now), now), now, 0.002);
}

TEST(LidarClock, FollowsASmallStepBackAfterTenSeconds) {
    Clocked sensor;
    LidarClock clock(kLd06ClockWrap);
    double now = sensor.began + 5.0;
    const auto run = [&](double seconds) {
        double stamp = 0.0;
        for (const double end = now + seconds; now < end; now += 0.01) stamp = clock.stamp(sensor.at(now), now);
        return stamp - (now - 0.01);
    };
    EXPECT_NEAR(run(20.0), 0.0, 0.002);
    sensor.began += 0.5; // the sensor's stamps are now 0.5 s early, which looks like late bytes
    EXPECT_NEAR(run(0.1), -0.5, 0.002);
    EXPECT_NEAR(run(12.0), 0.0, 0.002);
}

} // namespace
} // namespace scanloom::robot
