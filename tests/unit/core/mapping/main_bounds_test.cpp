#include "core/mapping/snapshot.hpp"

#include "core/mapping/projection.hpp"
#include "tests/support/random_scans.hpp"

#include <gtest/gtest.h>

namespace scanloom::mapping {
namespace {

using testing_support::random_scan;
using testing_support::small_laser;

/// Returns the map of one robot that took one scan at each place, in order; each scan reaches up to 4 m.
Snapshot seen_from(const std::vector<Point2>& places) {
    Projection projection{MapConfig{}};
    EXPECT_TRUE(projection.apply(RobotJoined{0, "r"}));
    EXPECT_TRUE(projection.apply(SensorDescribed{0, small_laser()}));
    for (const Point2& place : places) {
        Scan scan = random_scan(1, projection.state().robots[0].last_seq + 1);
        scan.pose = {place.x, place.y, 0.0};
        EXPECT_TRUE(projection.apply(ScanTaken{0, scan}));
    }
    return projection.snapshot();
}

TEST(MainBounds, WithoutStrayScanEqualAllBounds) {
    const auto maps = seen_from({{0.0, 0.0}, {5.0, 0.0}, {9.0, 3.0}});
    EXPECT_EQ(main_bounds_of(maps), bounds_of(maps));
}

TEST(MainBounds, ExcludeAStrayScanFarAway) {
    const std::vector<Point2> walk = {{0.0, 0.0}, {5.0, 0.0}, {9.0, 3.0}};
    auto with_stray = walk;
    with_stray.insert(with_stray.begin() + 1, {1e5, -1e5});
    const auto main = main_bounds_of(seen_from(with_stray));
    const auto wanted = bounds_of(seen_from(walk)); // main bounds consist of whole chunks
    EXPECT_GT(main.i_begin, wanted.i_begin - 128);
    EXPECT_GT(main.j_begin, wanted.j_begin - 128);
    EXPECT_LT(main.i_end, wanted.i_end + 128);
    EXPECT_LT(main.j_end, wanted.j_end + 128);
}

TEST(MainBounds, IncludeTheLargestAreaAndTheRobot) {
    const auto maps = seen_from({{0.0, 0.0}, {5.0, 0.0}, {9.0, 3.0}, {1e5, -1e5}, {100.0, 0.0}});
    const auto main = main_bounds_of(maps);
    EXPECT_EQ(main.i_begin, bounds_of(maps).i_begin) << "the largest scanned area is included";
    EXPECT_GT(main.i_end, 2000) << "the robot's position 100 m away is included";
    EXPECT_LT(main.i_end, 2200);
}

TEST(MainBounds, AreEmptyWithoutScans) { EXPECT_TRUE(main_bounds_of(seen_from({})).empty()); }

} // namespace
} // namespace scanloom::mapping
