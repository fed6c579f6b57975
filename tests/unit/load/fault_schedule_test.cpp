#include "load/core/fault_schedule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace scanloom::load {
namespace {

using testing::HasSubstr;

TEST(Faults, ParsesKindsWithTheirMeans) {
    const auto means = parse_faults("cut=20,stall=0.5");
    ASSERT_TRUE(means) << means.error().message;
    EXPECT_EQ(*means, (FaultMeans{20.0, 0.0, 0.5}));
    EXPECT_EQ(*parse_faults(""), FaultMeans{});
    EXPECT_EQ(*parse_faults("half-open=60"), (FaultMeans{0.0, 60.0, 0.0}));
}

TEST(Faults, InvalidTextIsRefusedWithAnExample) {
    for (const auto* text : {"cut", "cut=", "cut=x", "cut=5s", "crash=5", ",", "cut=5;stall=3"}) {
        const auto means = parse_faults(text);
        ASSERT_FALSE(means) << text;
        EXPECT_THAT(means.error().message, HasSubstr("cut=20,half-open=60,stall=30")) << text;
    }
    EXPECT_THAT(parse_faults("cut=0").error().message, HasSubstr("'cut=0': the mean is not within 0.1 to 1000000 s"));
    EXPECT_FALSE(parse_faults("cut=nan"));
    EXPECT_FALSE(parse_faults("cut=-1"));
}

TEST(FaultSchedule, KindsOccurAtTheirMeanRateOnAllRobots) {
    constexpr std::uint32_t kRobots = 10;
    FaultSchedule faults({20.0, 40.0, 0.0}, kRobots, 5); // together 0.5 and 0.25 faults per second for all robots
    std::map<Fault, int> kinds;
    std::map<std::uint32_t, int> robots;
    Micros time = 0;
    for (int i = 0; i < 30'000; ++i) {
        const auto event = faults.next();
        time += event.after;
        ++kinds[event.fault];
        ++robots[event.robot];
    }
    EXPECT_NEAR(in_seconds(time), 30'000 / 0.75, 1000.0);
    EXPECT_NEAR(kinds[Fault::kCut], 20'000, 400);
    EXPECT_NEAR(kinds[Fault::kHalfOpen], 10'000, 400);
    EXPECT_EQ(kinds.count(Fault::kStall), 0U);
    ASSERT_EQ(robots.size(), kRobots);
    for (const auto& [robot, times] : robots) EXPECT_NEAR(times, 3000, 300) << robot;
}

TEST(FaultSchedule, EqualSeedsGiveEqualFaults) {
    FaultSchedule one({1.0, 2.0, 3.0}, 100, 9);
    FaultSchedule same({1.0, 2.0, 3.0}, 100, 9);
    FaultSchedule other({1.0, 2.0, 3.0}, 100, 10);
    bool differs = false;
    for (int i = 0; i < 100; ++i) {
        const auto event = one.next();
        const auto again = same.next();
        EXPECT_TRUE(event.after == again.after && event.robot == again.robot && event.fault == again.fault);
        differs = differs || other.next().after != event.after;
    }
    EXPECT_TRUE(differs);
    EXPECT_TRUE(FaultSchedule(FaultMeans{}, 100, 9).is_empty());
}

} // namespace
} // namespace scanloom::load
