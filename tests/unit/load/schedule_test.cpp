#include "load/core/workload.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace scanloom::load {
namespace {

TEST(Schedule, SpreadsRobotsEvenlyOverThePeriod) {
    const Schedule schedule(4, 10.0); // every 100 ms; each robot 25 ms after the previous one
    EXPECT_EQ(schedule.due(0, 1), 0);
    EXPECT_EQ(schedule.due(1, 1), 25'000);
    EXPECT_EQ(schedule.due(3, 1), 75'000);
    EXPECT_EQ(schedule.due(0, 2), 100'000);
    EXPECT_EQ(schedule.due(3, 601), 60'075'000);
}

TEST(Schedule, PlacesAreScansOfAllRobotsInTimeOrder) {
    const Schedule schedule(7, 3.0);
    Micros before = -1;
    for (std::uint64_t place = 0; place < 100; ++place) {
        const auto robot = schedule.robot_at(place);
        const auto seq = schedule.seq_at(place);
        EXPECT_EQ(schedule.place_of(robot, seq), place);
        EXPECT_EQ(schedule.due(robot, seq), schedule.due(place));
        EXPECT_GT(schedule.due(place), before);
        before = schedule.due(place);
    }
}

TEST(Schedule, DoesNotDriftWithinADayOfFiveThousandRobots) {
    const Schedule schedule(5000, 10.0);
    EXPECT_EQ(schedule.due(0, 864'001), 86'400 * kSecond);
}

TEST(Schedule, CountsTheScansWithinTheDuration) {
    EXPECT_EQ(Schedule::scans_within(0.3, 10.0), 3U);
    EXPECT_EQ(Schedule::scans_within(30.0, 10.0), 300U);
    EXPECT_EQ(Schedule::scans_within(0.31, 10.0), 4U);
    EXPECT_EQ(Schedule::scans_within(0.001, 1.0), 1U);
}

TEST(Workload, RobotsGoToItsEndAndBack) {
    const auto course = [](std::size_t scans, std::size_t first) {
        const auto workload = make_workload({}, std::vector<Scan>(scans), 10.0, 1);
        std::vector<std::ptrdiff_t> places;
        for (std::uint64_t seq = 1; seq <= 6; ++seq) {
            places.push_back(scan_at(workload, first, seq).scan - workload.scans.data());
        }
        return places;
    };
    EXPECT_EQ(course(3, 0), (std::vector<std::ptrdiff_t>{0, 1, 2, 1, 0, 1}));
    EXPECT_EQ(course(3, 2), (std::vector<std::ptrdiff_t>{2, 1, 0, 1, 2, 1}));
    EXPECT_EQ(course(1, 0), (std::vector<std::ptrdiff_t>{0, 0, 0, 0, 0, 0}));
}

} // namespace
} // namespace scanloom::load
