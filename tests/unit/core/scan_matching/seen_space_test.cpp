#include "core/scan_matching/agreement.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"

#include <gtest/gtest.h>

namespace scanloom::scan_matching {
namespace {

using testing_support::Building;
using testing_support::uniform;

/// A room of 8 x 6 m with a box in it, seen from one place.
struct Room {
    Room() {
        building.add_box(-4.0, -3.0, 4.0, 3.0);
        building.add_box(1.0, -0.5, 2.0, 0.5);
        std::mt19937 random(1);
        const Sensor sensor = Building::laser();
        shown = points_of(building.scan(sensor, pose, 0.0, random), sensor);
        view = {transform_of(pose), shown.points, shown.laser};
        space = SeenSpace(std::span(&view, 1));
        map = PointMap(std::span(&view, 1));
    }

    Building building;
    Pose2 pose{-2.0, 0.3, 0.1};
    ScanPoints shown;
    View view;
    SeenSpace space;
    PointMap map;
};

TEST(SeenSpace, OnlyPlacesBeforeASurfaceAreFree) {
    const Room room;
    std::mt19937 random(2);
    int free = 0;
    for (int n = 0; n < 5000; ++n) {
        const Point2 at{uniform(random, -4.5, 4.5), uniform(random, -3.5, 3.5)};
        if (!room.space.is_free(at.x, at.y)) continue;
        ++free;
        const double dx = at.x - room.pose.x;
        const double dy = at.y - room.pose.y;
        const double distance = std::hypot(dx, dy);
        double wall = 0.0; // of the beams through the cell
        for (const double offset : {-0.12, 0.0, 0.12}) {
            const SinCos direction = SinCos{dy / distance, dx / distance} * sin_cos(offset / distance);
            wall = std::max(wall, room.building.range({room.pose.x, room.pose.y}, direction));
        }
        EXPECT_LT(distance, wall + 0.08) << at.x << ", " << at.y;
        EXPECT_GT(dx * std::cos(0.1) + dy * std::sin(0.1), -0.15) << "behind the laser";
    }
    EXPECT_GT(free, 1000);
}

TEST(SeenSpace, SurfacesAreNotFree) {
    const Room room;
    for (const auto& point : room.shown.points) {
        const Point2 at = room.view.T_map_robot * Point2{point.x, point.y};
        EXPECT_TRUE(room.space.has_point(at.x, at.y));
        for (const double dx : {-0.1, 0.0, 0.1}) EXPECT_TRUE(room.space.is_near_point(at.x + dx, at.y));
        EXPECT_FALSE(room.space.is_free(at.x, at.y));
    }
    EXPECT_FALSE(room.space.has_point(100.0, 0.0));
    EXPECT_FALSE(SeenSpace().is_free(0.0, 0.0));
    EXPECT_TRUE(SeenSpace().is_empty());
    const View nothing{Transform2(), {}};
    const SeenSpace empty(std::span(&nothing, 1));
    EXPECT_TRUE(empty.is_empty());
    EXPECT_FALSE(empty.is_free(1.0, 1.0));
    EXPECT_FALSE(room.space.is_free(1e30, -1e30));
}

TEST(Agreement, IsHighestAtTheTruePose) {
    const Room room;
    const auto at = [&](const Pose2& pose) {
        return agreement_of(room.shown, room.map, room.space, transform_of(pose));
    };
    const Agreement truth = at(room.pose);
    EXPECT_EQ(truth.inlier_ratio, 1.0);
    EXPECT_EQ(truth.outlier_ratio, 0.0);
    EXPECT_GT(truth.score, 0.95);
    std::mt19937 random(3);
    for (int n = 0; n < 200; ++n) {
        Pose2 off{room.pose.x + uniform(random, -1.0, 1.0), room.pose.y + uniform(random, -1.0, 1.0),
                  room.pose.yaw + uniform(random, -1.0, 1.0)};
        EXPECT_LT(at(off).score, truth.score);
    }
    EXPECT_GT(at({room.pose.x - 0.6, room.pose.y, room.pose.yaw}).outlier_ratio, 0.1)
        << "walls in front of the old ones";
    EXPECT_EQ(agreement_of({}, room.map, room.space, Transform2()).score, 0.0);
}

TEST(Agreement, PointsWhereTheMapShowsNothingCountNeitherWay) {
    const Room room;
    ScanPoints scan = room.shown;
    const auto agreement = [&] { return agreement_of(scan, room.map, room.space, transform_of(room.pose)); };
    const double score = agreement().score;
    const std::size_t shown = scan.points.size();
    for (std::size_t n = 0; n < shown; ++n) scan.points.push_back({.x = -50.0F, .y = 0.1F * static_cast<float>(n)});
    EXPECT_NEAR(agreement().score, score, 1e-12);
    EXPECT_EQ(agreement().inlier_ratio, 0.5);
    EXPECT_EQ(agreement().outlier_ratio, 0.0);
    for (std::size_t n = 0; n < 2 * shown; ++n) scan.points.push_back({.x = -60.0F, .y = 0.1F * static_cast<float>(n)});
    EXPECT_NEAR(agreement().score, 0.5 * score, 1e-12) << "a pose where most is new is not a good one";
}

} // namespace
} // namespace scanloom::scan_matching
