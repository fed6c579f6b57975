#include "sim/robot/simulated_robot.hpp"

#include "sim/robot/waypoint_list.hpp"
#include "sim/world.hpp"
#include "tests/support/point_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace scanloom::sim {
namespace {

SimulatedRobot made(const std::string& drive, const std::string& world = "room", const std::string& waypoints = {}) {
    SimulatedRobotOptions options;
    options.world = world;
    options.drive = drive;
    options.waypoints = waypoints;
    auto result = make_simulated_robot(options);
    EXPECT_TRUE(result) << result.error().message;
    return std::move(*result);
}

TEST(SimulatedRobot, EachDriveHasItsOwnFingerprint) {
    const std::set<std::string> fingerprints{made("wall_follower").fingerprint,
                                             made("zigzag").fingerprint,
                                             made("waypoints").fingerprint,
                                             made("waypoints", "room", "1,2").fingerprint,
                                             made("waypoints", "room", "2,1").fingerprint,
                                             made("waypoints", "office").fingerprint};
    EXPECT_EQ(fingerprints.size(), 6U);
    EXPECT_EQ(made("waypoints", "room", "1,2").fingerprint, made("waypoints", "room", "1.0 2.0;").fingerprint);
}

TEST(SimulatedRobot, PosesSayWhatIsSent) {
    const auto first_of = [](Poses poses, const char* pose, std::set<std::string>& fingerprints) {
        SimulatedRobotOptions options;
        options.poses = poses;
        options.world = "room";
        options.noise = "gaussian";
        options.pose = pose;
        auto robot = make_simulated_robot(options);
        EXPECT_TRUE(robot) << robot.error().message;
        fingerprints.insert(robot->fingerprint);
        for (int i = 0; i < 20; ++i) static_cast<void>(robot->source->next());
        return robot->source->next().value()->scan;
    };
    std::set<std::string> fingerprints;
    const Scan exact = first_of(Poses::kMap, "true", fingerprints);
    const Scan drifting = first_of(Poses::kMap, "odometry", fingerprints);
    const Scan odometry = first_of(Poses::kOdometry, "true", fingerprints);
    const Scan none = first_of(Poses::kNone, "true", fingerprints);
    EXPECT_EQ(fingerprints.size(), 4U);
    EXPECT_NE(drifting.pose, exact.pose);
    EXPECT_EQ(odometry.odometry, drifting.pose);
    EXPECT_FALSE(odometry.pose);
    EXPECT_FALSE(none.pose || none.odometry);
    EXPECT_EQ(first_of(Poses::kOdometry, "odometry", fingerprints), odometry);
    EXPECT_EQ(fingerprints.size(), 4U) << "these are the same scans";
}

TEST(SimulatedRobot, ExplorerIsLiveWithoutFingerprint) {
    const auto exploring = made("explore");
    EXPECT_EQ(exploring.source, nullptr);
    ASSERT_NE(exploring.exploring, nullptr);
    EXPECT_EQ(exploring.fingerprint, "");
    EXPECT_TRUE(exploring.exploring->can_wait());
}

TEST(SimulatedRobot, EndsWithItsDrive) {
    auto source = made("waypoints", "room", "1,3.5").source;
    EXPECT_EQ(source->scan_count(), std::nullopt) << "not known in advance";
    std::uint64_t scans = 0;
    while (*source->next()) ASSERT_LT(++scans, 6000U);
    EXPECT_GT(scans, 50U);
    EXPECT_EQ(source->scan_count(), scans);
    EXPECT_TRUE(source->remarks().starts_with("waypoints: ")) << source->remarks();
    EXPECT_FALSE(*source->next());
}

TEST(SimulatedRobot, UnreachableWaypointsAreRefusedWithTheReason) {
    const World room = make_room();
    const Box inner = *std::ranges::find_if(
        room.solids, [](const Box& box) { return std::max(std::abs(box.x_min), std::abs(box.x_max)) < 4.0; });
    const Point2 middle{(inner.x_min + inner.x_max) / 2.0, (inner.y_min + inner.y_max) / 2.0};
    const Point2 outside{inner.x_min - 0.1, middle.y};
    auto source = made("waypoints", "room", to_text({{40.0, 0.0}, middle, outside})).source;
    while (*source->next()) {
    }
    EXPECT_THAT(source->remarks(),
                testing::StartsWith("waypoints: 0 of 3 reached, 3 abandoned: (40, 0) outside the world"));
    EXPECT_THAT(source->remarks(), testing::HasSubstr(") inside an obstacle, ("));
    EXPECT_THAT(source->remarks(), testing::EndsWith(") too close to an obstacle"));
}

TEST(SimulatedRobot, LimitEndsALongerDrive) {
    SimulatedRobotOptions options;
    options.world = "room";
    options.drive = "zigzag";
    options.scans = 20;
    const auto limited = make_simulated_robot(options);
    ASSERT_TRUE(limited);
    robot::Source* source = limited->source.get();
    std::uint64_t scans = 0;
    while (*source->next()) ++scans;
    EXPECT_EQ(scans, 20U);
    EXPECT_EQ(source->scan_count(), 20U);
}

TEST(SimulatedRobot, NamedWorldsHaveCollisionFreeTours) {
    for (const NamedWorld& named : kWorlds) {
        World world = named.make();
        world.walkers.clear(); // they move
        const auto tour = tour_of(named.name);
        EXPECT_GT(tour.size(), 5U) << named.name;
        for (const Point2& waypoint : tour) {
            EXPECT_GT(clearance(world, waypoint), 0.5) << named.name << ' ' << testing_support::text_of(waypoint);
        }
    }
    EXPECT_TRUE(tour_of("somewhere").empty());
}

} // namespace
} // namespace scanloom::sim
