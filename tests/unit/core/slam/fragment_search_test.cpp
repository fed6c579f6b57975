#include "tests/unit/core/slam/other_buildings.hpp"
#include "tests/unit/core/slam/two_robots.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::points_of;
using testing_support::Building;

const Drive& lap() {
    static const Drive drive = drive_along(ring_building(), kLapAndAQuarter, {.scale = 1.02, .turn = 0.003}, 1);
    return drive;
}

TEST(FragmentSearch, LocatesARobotThatStartsAnywhere) {
    const std::vector<Point2> way{{24.0, 21.0}, {1.0, 21.0}, {1.0, 8.0}};
    const Drive second = drive_along(ring_building(), way, {.scale = 0.98, .turn = -0.003}, 2);
    const TwoRobots robots(lap(), second);
    ASSERT_TRUE(robots.located_at());
    EXPECT_LT(*robots.located_at(), 250U) << "within 25 m";
    EXPECT_LT(robots.largest_error(), 0.15);
    for (std::size_t n = 0; n < second.scans.size(); ++n)
        ASSERT_TRUE(robots.second().is_fragment_located(n)) << "also before";
    EXPECT_FALSE(robots.second().needs_place());
    EXPECT_GT(robots.second().loop_count(), 3U);
}

TEST(FragmentSearch, LocatesARobotWithoutOdometryAgainstTheDirectionOfTheFirst) {
    const std::vector<Point2> way{{20.0, 21.0}, {33.0, 21.0}, {33.0, 15.0}};
    const Drive second = drive_along(ring_building(), way, {}, 3);
    const TwoRobots robots(lap(), second, {.has_odometry = false});
    ASSERT_TRUE(robots.located_at());
    EXPECT_LT(robots.largest_error(), 0.15);
}

TEST(FragmentSearch, DoesNotLocateARobotThatStaysAtOnePlace) {
    Drive second = drive_along(
        ring_building(), std::vector<Point2>{{10.0, 1.0}, {12.0, 1.0}, {10.0, 1.0}, {12.0, 1.0}, {10.0, 1.0}}, {}, 4);
    EXPECT_FALSE(TwoRobots(lap(), second).located_at()) << "one view is not enough, whatever it shows";
}

TEST(FragmentSearch, ARobotThatIsNotLocatedClosesItsOwnLoops) {
    const Drive first = drive_along(other_building(), std::vector<Point2>{{1.0, 1.0}, {6.0, 1.0}}, {}, 12);
    const TwoRobots robots(first, lap());
    EXPECT_FALSE(robots.located_at());
    EXPECT_GT(robots.second().loop_count(), 3U);
    EXPECT_LT(largest_error(lap(), [&](std::size_t n) { return robots.second().pose_of(n); }), 0.15);
}

TEST(FragmentSearch, DoesNotLocateARobotInAnotherBuilding) {
    const TwoRobots robots(lap(), drive_in_other_building());
    EXPECT_FALSE(robots.located_at());
    EXPECT_TRUE(robots.second().needs_place());
    EXPECT_TRUE(std::ranges::none_of(robots.map().graph().edges(), [&](const Edge& edge) {
        return robots.map().graph().fragment_of(edge.from).robot != robots.map().graph().fragment_of(edge.to).robot;
    }));
}

/// Five rooms on a corridor, in a map that is complete: answers over 2 m would be enough.
TEST(FragmentSearch, ChoosesBetweenRoomsOnlyIfTheyDiffer) {
    const auto rooms = [](double difference) { // metres, between the boxes of neighbouring rooms
        Building building;
        building.add_box(0.0, 0.0, 30.0, 8.0);
        for (int n = 0; n < 5; ++n) {
            const double x = 6.0 * n;
            building.walls.push_back({{x, 2.4}, {x + 2.5, 2.4}});
            building.walls.push_back({{x + 3.7, 2.4}, {x + 6.0, 2.4}});
            building.walls.push_back({{x, 2.4}, {x, 8.0}});
            building.add_box(x + 0.5, 7.0 - difference * n, x + 2.0, 8.0);
            building.add_box(x + 5.0 - difference * n, 4.0, x + 6.0, 5.5);
        }
        return building;
    };
    std::vector<Point2> visits;
    for (int n = 0; n < 5; ++n) {
        for (const Point2& at : {Point2{3.1, 1.2}, {3.1, 3.5}, {2.5, 4.5}, {3.1, 5.0}, {3.1, 3.5}, {3.1, 1.2}}) {
            visits.push_back({at.x + 6.0 * n, at.y});
        }
    }
    const std::vector<Point2> in_the_third{{15.1, 3.3}, {14.1, 5.0}, {15.2, 5.6}, {13.2, 5.0},
                                           {15.4, 3.3}, {13.2, 5.0}, {15.2, 5.6}};
    for (const double difference : {0.0, 0.3}) {
        const Building building = rooms(difference);
        const Drive first = drive_along(building, visits, {}, 6);
        std::vector<KnownView> views;
        for (std::size_t n = 0; n < first.scans.size(); n += 4) {
            views.push_back({scan_matching::transform_of(first.truth[n]), points_of(first.scans[n], first.laser)});
        }
        SharedMap map;
        map.begin_with(std::move(views), true);
        TrajectoryEstimator robot(map, 1);
        const Drive second = drive_along(building, in_the_third, {}, 7);
        for (std::size_t n = 0; n < second.scans.size(); ++n) {
            robot.add(points_of(second.scans[n], second.laser), second.odometry[n]);
        }
        ASSERT_EQ(robot.located_fragments(), difference > 0.0 ? 1U : 0U) << difference;
        if (difference == 0.0) continue;
        const Pose2 found = robot.pose_of(second.scans.size() - 1);
        EXPECT_LT(std::hypot(found.x - second.truth.back().x, found.y - second.truth.back().y), 0.1);
    }
}

/// Returns a hall of 18 x 12 m with boxes.
Building hall() {
    Building building;
    building.add_box(0.0, 0.0, 18.0, 12.0);
    building.add_box(2.0, 2.0, 3.2, 5.0);
    building.add_box(6.0, 1.8, 8.5, 2.6);
    building.add_box(12.0, 3.0, 13.0, 4.0);
    building.add_box(5.0, 6.0, 6.0, 9.5);
    building.add_box(9.0, 5.5, 12.0, 6.5);
    building.add_box(14.5, 8.0, 16.0, 8.6);
    building.add_box(8.5, 9.8, 10.5, 10.4);
    return building;
}

/// A robot is carried in the arms, where its laser sees nothing, and its odometry does not notice.
TEST(FragmentSearch, LocatesARobotThatWasCarriedAgain) {
    const std::vector<Point2> round{{1.0, 1.0}, {16.5, 1.2}, {17.0, 10.8}, {12.0, 11.2}, {7.5, 8.0},
                                    {7.5, 4.5}, {4.0, 5.5},  {3.5, 10.5},  {1.0, 10.0},  {1.0, 2.0}};
    const Drive before = drive_along(hall(), round, {.scale = 1.02, .turn = 0.003}, 8);
    const std::vector<Point2> elsewhere{{16.0, 4.5}, {14.0, 5.5}, {16.8, 6.8}, {16.8, 10.5}, {11.5, 11.2},
                                        {7.5, 8.0},  {7.5, 4.5},  {4.0, 5.5},  {3.5, 10.5}};
    const Drive after = drive_along(hall(), elsewhere, {.scale = 1.02}, 9);
    SharedMap map;
    TrajectoryEstimator estimator(map);
    for (std::size_t n = 0; n < before.scans.size(); ++n) {
        estimator.add(points_of(before.scans[n], before.laser), before.odometry[n]);
    }
    for (int n = 0; n < 30; ++n) estimator.add({}, before.odometry.back());
    EXPECT_TRUE(estimator.needs_place());
    const std::size_t carried = estimator.scan_count();
    for (std::size_t n = 0; n < after.scans.size(); ++n) {
        estimator.add(points_of(after.scans[n], after.laser), compose(before.odometry.back(), after.odometry[n]));
    }
    estimator.finish();
    map.finish();
    EXPECT_FALSE(estimator.needs_place());
    const Pose2 T_truth_map = compose(before.truth.front(), inverse(estimator.pose_of(0)));
    for (std::size_t n = 0; n < after.scans.size(); ++n) {
        ASSERT_TRUE(estimator.is_located(carried + n)) << n;
        const Pose2 pose = compose(T_truth_map, estimator.pose_of(carried + n));
        ASSERT_LT(std::hypot(pose.x - after.truth[n].x, pose.y - after.truth[n].y), 0.2) << n;
    }
}

/// A map that shows all places that may look alike needs answers over 2 m, others over 10 m.
TEST(FragmentSearch, LocatesARobotSoonerInAMapThatIsComplete) {
    const std::vector<Point2> way{{10.0, 1.0}, {14.0, 1.0}, {10.0, 1.0}, {14.0, 1.0}, {10.0, 1.0}, {14.0, 1.0}};
    const Drive second = drive_along(ring_building(), way, {}, 14);
    const auto is_located = [&](bool is_imported, bool is_frozen, bool grows) {
        std::vector<KnownView> views;
        for (std::size_t n = 0; n < lap().scans.size(); n += 8) {
            views.push_back({scan_matching::transform_of(lap().truth[n]), points_of(lap().scans[n], lap().laser)});
        }
        SharedMap map;
        if (is_frozen) map.freeze(true);
        map.begin_with(views, is_imported);
        if (grows) map.add_given(0, views[0].points, views[0].T_map_laser);
        TrajectoryEstimator estimator(map, 1);
        for (std::size_t n = 0; n < second.scans.size(); ++n)
            estimator.add(points_of(second.scans[n], second.laser), second.odometry[n]);
        return estimator.located_fragments() > 0;
    };
    EXPECT_TRUE(is_located(true, false, false)) << "imported";
    EXPECT_FALSE(is_located(true, false, true)) << "a robot adds to it";
    EXPECT_FALSE(is_located(false, false, false)) << "made by robots";
    EXPECT_TRUE(is_located(false, true, false)) << "and finished";
}

/// Robots that stop before a search has ended keep what they look for, but not the grids of the whole map.
TEST(FragmentSearch, RobotsThatStoppedDoNotKeepMapsInMemory) {
    const Drive& elsewhere = drive_in_other_building();
    SharedMap map;
    TrajectoryEstimator mapper(map, 0);
    std::vector<std::unique_ptr<TrajectoryEstimator>> robots;
    std::size_t scans = 0;
    std::size_t most = 0;
    for (std::size_t n = 0; n < lap().scans.size(); ++n) {
        mapper.add(points_of(lap().scans[n], lap().laser), lap().odometry[n]);
        if (n % 200 == 199) {
            auto& robot = robots.emplace_back(std::make_unique<TrajectoryEstimator>(map, robots.size() + 1));
            for (scans = 0; scans < 60; ++scans)
                robot->add(points_of(elsewhere.scans[scans], elsewhere.laser), elsewhere.odometry[scans]);
        }
        most = std::max(most, map.fragment_search().place_map_count());
    }
    EXPECT_GE(robots.size(), 4U);
    EXPECT_EQ(most, 2U) << "the newest one and the one before";
    for (; scans < 80; ++scans) { // one that goes on makes its search again
        robots.front()->add(points_of(elsewhere.scans[scans], elsewhere.laser), elsewhere.odometry[scans]);
    }
    EXPECT_EQ(robots.front()->located_fragments(), 0U);
}

/// People say where a robot is that stands: one scan is enough then.
TEST(FragmentSearch, LocatesAStandingRobotWherePeopleSayThatItIs) {
    const std::vector<Point2> round{{1.0, 1.0}, {16.5, 1.2}, {17.0, 10.8}, {12.0, 11.2}, {7.5, 8.0}};
    const Drive first = drive_along(hall(), round, {}, 10);
    const Drive second = drive_along(hall(), std::vector<Point2>{{15.0, 5.0}, {14.0, 4.5}, {13.8, 6.0}}, {}, 11);
    for (const bool is_right : {true, false}) {
        SharedMap map;
        TrajectoryEstimator a(map, 0);
        TrajectoryEstimator b(map, 1);
        for (std::size_t n = 0; n < first.scans.size(); ++n)
            a.add(points_of(first.scans[n], first.laser), first.odometry[n]);
        b.add(points_of(second.scans[0], second.laser), std::nullopt);
        EXPECT_TRUE(b.needs_place());
        const Pose2 truth = compose(inverse(first.truth[0]), second.truth[0]);
        b.relocalize({{truth.x + (is_right ? 1.5 : 8.0), truth.y - 1.0}, 3.0});
        b.add(points_of(second.scans[0], second.laser), std::nullopt);
        ASSERT_EQ(b.is_located(1), is_right) << "elsewhere nothing fits";
        if (!is_right) continue;
        const Pose2 found = b.pose_of(1);
        EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.05);
        EXPECT_TRUE(b.is_located(0)) << "the fragment is located as a whole";
        for (std::size_t n = 1; n < second.scans.size(); ++n)
            b.add(points_of(second.scans[n], second.laser), std::nullopt);
        b.finish();
        const Pose2 end = compose(inverse(first.truth[0]), second.truth.back());
        EXPECT_LT(std::hypot(b.pose_of(b.scan_count() - 1).x - end.x, b.pose_of(b.scan_count() - 1).y - end.y), 0.15);
    }
}

TEST(FragmentSearch, AWrongHintIsForgottenAfterAWhile) {
    const std::vector<Point2> way{{24.0, 21.0}, {1.0, 21.0}, {1.0, 1.0}, {30.0, 1.0}};
    const Drive second = drive_along(ring_building(), way, {.scale = 0.98, .turn = -0.003}, 13);
    SharedMap map;
    TrajectoryEstimator a(map, 0);
    TrajectoryEstimator b(map, 1);
    for (std::size_t n = 0; n < lap().scans.size(); ++n)
        a.add(points_of(lap().scans[n], lap().laser), lap().odometry[n]);
    b.relocalize({{60.0, -30.0}, 2.0}); // outside
    for (std::size_t n = 0; n < second.scans.size(); ++n) {
        b.add(points_of(second.scans[n], second.laser), second.odometry[n]);
        if (n == 190) {
            ASSERT_EQ(b.located_fragments(), 0U) << "within 19 m";
        }
    }
    EXPECT_EQ(b.located_fragments(), 1U);
}

TEST(FragmentSearch, ATrackedRobotGoesOnThereAfterAWrongHint) {
    const std::vector<Point2> way{{10.0, 1.0}, {33.0, 1.0}, {33.0, 21.0}, {1.0, 21.0},
                                  {1.0, 1.0},  {33.0, 1.0}, {33.0, 15.0}};
    const Drive drive = drive_along(ring_building(), way, {.scale = 1.01, .turn = 0.002}, 14);
    LoneEstimator lone;
    const std::size_t told = drive.scans.size() - 300; // 10 cm between them, and some turns
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        if (n == told) lone->relocalize({{60.0, -30.0}, 2.0}); // outside
        lone->add(points_of(drive.scans[n], drive.laser), drive.odometry[n]);
        if (n == told + 190) {
            EXPECT_TRUE(lone->needs_place()) << "people may be right for 20 m";
        } else if (n == told + 240) {
            EXPECT_FALSE(lone->needs_place());
        }
    }
    lone.finish();
    EXPECT_EQ(lone.map->graph().fragments().size(), 2U);
    EXPECT_LT(largest_error(drive, [&](std::size_t n) { return lone->pose_of(n); }), 0.2);
}

/// A robot that is tracked at a wrong place is put right: its scans from there on are a fragment of their own.
TEST(FragmentSearch, ALocatedRobotGoesOnWherePeopleSayThatItIs) {
    const std::vector<Point2> round{{1.0, 1.0}, {16.5, 1.2}, {17.0, 10.8}, {12.0, 11.2}, {7.5, 8.0}};
    const Drive drive = drive_along(hall(), round, {}, 12);
    SharedMap map;
    TrajectoryEstimator estimator(map);
    for (std::size_t n = 0; n < drive.scans.size(); ++n)
        estimator.add(points_of(drive.scans[n], drive.laser), drive.odometry[n]);
    const Pose2 before = estimator.pose_of(100);
    constexpr std::size_t kCarriedTo = 120; // a scan of the way
    const Pose2 truth = compose(inverse(drive.truth[0]), drive.truth[kCarriedTo]);
    estimator.relocalize({{truth.x + 0.5, truth.y}, 2.0});
    estimator.add(points_of(drive.scans[kCarriedTo], drive.laser), drive.odometry.back());
    const Pose2 found = estimator.pose_of(estimator.scan_count() - 1);
    EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.15);
    EXPECT_FALSE(estimator.needs_place());
    EXPECT_NEAR(estimator.pose_of(100).x, before.x, 1e-6) << "what was before stays";
    EXPECT_NEAR(estimator.pose_of(100).y, before.y, 1e-6);
}

} // namespace
} // namespace scanloom::slam
