#include "robot_client/source/simulated_source.hpp"

#include "robot_client/drive/wall_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace scanloom::robot {
namespace {

SimulatedSource make(SimulationLimits limits, NoReturn no_return = NoReturn::kFree) {
    return {Simulator({make_office(), *find_laser("reference"), std::nullopt, 3}, std::make_unique<WallFollower>()),
            limits, no_return};
}

std::size_t count(SimulatedSource& source) {
    std::size_t scans = 0;
    while (*source.next()) ++scans;
    return scans;
}

TEST(SimulatedSource, EndsAtTheFirstOfItsLimits) {
    for (const auto& [duration, scans, expected] :
         {std::tuple{3.0, 1000U, 30U}, {0.3, 1000U, 3U}, {100.0, 7U, 7U}, {0.31, 99U, 4U}}) {
        auto source = make({duration, scans});
        EXPECT_EQ(source.scan_count(), expected);
        EXPECT_EQ(count(source), expected);
    }
}

TEST(SimulatedSource, WithoutLimitsItsLengthIsNotKnown) { EXPECT_EQ(make({}).scan_count(), std::nullopt); }

TEST(SimulatedSource, MadeAnewItGivesTheSameScansAgain) {
    auto first = make({.scans = 20});
    auto second = make({});
    for (int i = 0; i < 20; ++i) EXPECT_EQ((*second.next())->scan, (*first.next())->scan);
}

TEST(SimulatedSource, BeamsWithoutReturnAreFreeOrDropped) {
    const auto has = [](const Scan& scan, RangeMm mark) {
        return std::count(scan.ranges.begin(), scan.ranges.end(), mark) > 0;
    };
    auto free = make({.scans = 1});
    auto drop = make({.scans = 1}, NoReturn::kDrop);
    const Scan freed = (*free.next())->scan;
    const Scan dropped = (*drop.next())->scan;
    EXPECT_TRUE(has(freed, kNoReturn) && !has(freed, kInvalidRange));
    EXPECT_TRUE(has(dropped, kInvalidRange) && !has(dropped, kNoReturn));
}

} // namespace
} // namespace scanloom::robot
