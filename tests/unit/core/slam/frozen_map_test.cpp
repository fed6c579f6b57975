#include "tests/unit/core/slam/two_robots.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::points_of;

/// A lap and a quarter of the ring, with odometry that drifts by metres.
const Drive& first_lap() {
    static const Drive drive = drive_along(ring_building(), kLapAndAQuarter, {.scale = 1.02, .turn = 0.003}, 1);
    return drive;
}

/// The robot's estimator and its map.
class FrozenMap : public testing::Test {
protected:
    void add(const Drive& drive, std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            estimator_.add(points_of(drive.scans[n], drive.laser), drive.odometry[n]);
        }
    }

    void finish() {
        estimator_.finish();
        map_.finish();
    }

    [[nodiscard]] double largest_error_of(const Drive& drive) const {
        return largest_error(drive, [&](std::size_t n) { return estimator_.pose_of(n); });
    }

    SharedMap map_;
    TrajectoryEstimator estimator_{map_};
};

TEST_F(FrozenMap, RobotsAreLocatedInItAndItStaysAsItIs) {
    const std::vector<Point2> lap{{24.0, 21.0}, {1.0, 21.0}, {1.0, 1.0}, {33.0, 1.0}, {33.0, 20.0}};
    const Drive second = drive_along(ring_building(), lap, {.scale = 0.97, .turn = -0.005}, 2);
    const TwoRobots robots(first_lap(), second, {.is_frozen = true});
    ASSERT_TRUE(robots.located_at());
    EXPECT_LT(*robots.located_at(), 200U) << "within 20 m";
    EXPECT_LT(robots.largest_error(), 0.15);
    const auto& graph = robots.map().graph();
    EXPECT_TRUE(std::ranges::equal(robots.before(), graph.poses().first(robots.before().size())));
    EXPECT_EQ(robots.second().keyframes().size(), graph.size() - robots.before().size());
    EXPECT_LT(graph.size() - robots.before().size(), 30U) << "keyframes only until the robot was located";
    for (std::size_t n = robots.before().size(); n < graph.size(); ++n) EXPECT_FALSE(graph.is_in_map(n));
}

TEST_F(FrozenMap, TheRobotThatMadeItGoesOnWithoutKeyframes) {
    const std::size_t lap = first_lap().scans.size() * 85 / 100; // the rest is known
    add(first_lap(), 0, lap);
    estimator_.finish();
    map_.freeze(true);
    const std::size_t keyframes = map_.graph().size();
    add(first_lap(), lap, first_lap().scans.size());
    finish();
    EXPECT_EQ(map_.graph().size(), keyframes);
    EXPECT_FALSE(estimator_.needs_place());
    EXPECT_EQ(estimator_.unmatched_count(), 0U);
    EXPECT_LT(largest_error_of(first_lap()), 0.3);
}

TEST_F(FrozenMap, MappingGoesOnWhereTheRobotIs) {
    const std::size_t length = first_lap().scans.size();
    add(first_lap(), 0, length / 3);
    estimator_.finish();
    map_.freeze(true);
    const std::size_t keyframes = map_.graph().size();
    add(first_lap(), length / 3, length / 2); // beyond the map, by what the robot saw itself
    EXPECT_FALSE(estimator_.needs_place());
    EXPECT_EQ(map_.graph().size(), keyframes);
    map_.freeze(false);
    add(first_lap(), length / 2, length);
    finish();
    EXPECT_GT(map_.graph().size(), keyframes + 50);
    EXPECT_EQ(map_.graph().fragments().size(), 2U);
    EXPECT_GT(estimator_.loop_count(), 3U) << "also between the parts before and after";
    EXPECT_LT(largest_error_of(first_lap()), 0.3);
}

TEST_F(FrozenMap, WithoutPlacesLocatesNoRobotUntilMappingBegins) {
    map_.freeze(true);
    add(first_lap(), 0, 60);
    EXPECT_TRUE(estimator_.needs_place());
    EXPECT_FALSE(estimator_.is_located(0));
    map_.freeze(false);
    add(first_lap(), 60, 120);
    EXPECT_FALSE(estimator_.needs_place());
    EXPECT_TRUE(estimator_.is_located(0));
}

} // namespace
} // namespace scanloom::slam
