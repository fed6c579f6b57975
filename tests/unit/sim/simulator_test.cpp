#include "sim/simulator.hpp"

#include "sim/drive/wall_follower.hpp"
#include "sim/ray_casting.hpp"
#include "tests/support/angles.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace scanloom::sim {
namespace {

Simulator make(const char* world, std::uint64_t seed, std::optional<Noise> noise = {},
               const char* laser = "reference") {
    return {{*find_world(world), *find_laser(laser), noise, seed}, std::make_unique<WallFollower>()};
}

TEST(Simulator, StartsAtTheGivenPose) {
    const Pose2 start{1.2, 3.4, 0.5};
    Simulator simulator({make_room(), *find_laser("reference"), std::nullopt, 1, start},
                        std::make_unique<WallFollower>());
    EXPECT_EQ(simulator.next_scan().pose, start);
}

TEST(Simulator, WalkersMoveBetweenScansAndAreVisible) {
    auto walked = make("room_walker", 3);
    auto still = make("room", 3);
    const double before = walked.world().walkers.at(0).walked;
    bool is_seen = false;
    for (int i = 0; i < 50; ++i) is_seen |= walked.next_scan().ranges != still.next_scan().ranges;
    EXPECT_TRUE(is_seen);
    EXPECT_NEAR(walked.world().walkers.at(0).walked - before, 4.9, 1e-9);
}

/// Walks in a circle.
class Circling final : public Behaviour {
public:
    Velocity step(const Senses&) override { return {kForwardMax, kWalkMax.turn}; }
};

TEST(Simulator, BeamsOfACarriedLaserAreTakenWhileItMoves) {
    const World room = make_room();
    SimulatorOptions options{room, *find_laser("handheld"), std::nullopt, 1, Pose2{0.5, -1.0, 0.0}};
    options.is_carried = true;
    Simulator simulator(std::move(options), std::make_unique<Circling>());
    EXPECT_EQ(simulator.next_scan().pose, (Pose2{0.5, -1.0, 0.0}));
    for (int n = 1; n < 15; ++n) {
        const Scan scan = simulator.next_scan();
        ASSERT_EQ(simulator.collisions(), 0U);
        ASSERT_NEAR(scan.stamp, 0.1 * n, 1e-9);
        ASSERT_NEAR(scan.duration, 0.1 * 449 / 450, 1e-9);
        for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
            // It walks from 0.05 s on: the first turn, at rest, ends there. 1 m/s and 90 degrees/s: a radius of 2/pi m.
            const double seconds = scan.stamp + scan.duration * (static_cast<double>(i) / 449.0 - 0.5) - 0.05;
            const double yaw = kWalkMax.turn * seconds;
            const double radius = kWalkMax.forward / kWalkMax.turn;
            const Point2 place{0.5 + radius * std::sin(yaw), -1.0 + radius * (1.0 - std::cos(yaw))};
            const double range =
                cast_ray(room.outlines, place, yaw + (-180.0 + 0.8 * static_cast<double>(i)) * kDegree);
            ASSERT_NEAR(scan.ranges[i] * 1e-3, range, 0.0006) << "scan " << n << ", beam " << i;
        }
        const double yaw = kWalkMax.turn * (scan.stamp - 0.05);
        ASSERT_NEAR(normalize_angle(scan.pose->yaw - yaw), 0.0, 1e-9) << "the pose is that at the stamp";
    }
}

TEST(Simulator, OdometryWithoutNoiseEqualsTheTrajectory) {
    auto simulator = make("room", 2);
    const Pose2 start = *simulator.next_scan().pose;
    Scan scan;
    for (int i = 0; i < 600; ++i) scan = simulator.next_scan();
    const Pose2 estimated = compose(start, *scan.odometry);
    EXPECT_NEAR(estimated.x, scan.pose->x, 1e-9);
    EXPECT_NEAR(estimated.y, scan.pose->y, 1e-9);
}

TEST(Simulator, OdometryNoiseDriftIsBounded) {
    auto simulator = make("room", 2, Noise{});
    const Pose2 start = *simulator.next_scan().pose;
    Scan scan;
    for (int i = 0; i < 600; ++i) scan = simulator.next_scan();
    const Pose2 estimated = compose(start, *scan.odometry);
    const double drift = std::hypot(estimated.x - scan.pose->x, estimated.y - scan.pose->y);
    EXPECT_GT(drift, 1e-4);
    EXPECT_LT(drift, 2.0);
}

TEST(Simulator, SentPoseCanBeTheOdometry) {
    SimulatorOptions options{make_room(), *find_laser("reference"), Noise{}, 2};
    options.pose = PoseSent::kOdometry;
    Simulator simulator(std::move(options), std::make_unique<WallFollower>());
    auto exact_robot = make("room", 2, Noise{});
    const Pose2 start = simulator.pose();
    for (int i = 0; i < 300; ++i) {
        const Scan scan = simulator.next_scan();
        const Scan exact = exact_robot.next_scan();
        EXPECT_EQ(scan.pose, compose(start, *scan.odometry));
        EXPECT_EQ(scan.ranges, exact.ranges) << "the real pose must not depend on the estimated pose";
        EXPECT_EQ(simulator.pose(), exact.pose);
        EXPECT_EQ(scan.pose == exact.pose, i == 0) << i;
    }
}

/// Stands, and keeps what it senses.
class Standing final : public Behaviour {
public:
    Velocity step(const Senses& senses) override {
        sensed = senses;
        return {};
    }

    Senses sensed;
};

TEST(Simulator, CorrectionsMoveTheSensedPoseAndObstacles) {
    SimulatorOptions options{make_room(), *find_laser("reference"), std::nullopt, 2};
    options.pose = PoseSent::kOdometry;
    options.poses = Poses::kOdometry;
    auto standing = std::make_unique<Standing>();
    const auto& sensed = standing->sensed;
    Simulator simulator(std::move(options), std::move(standing));
    for (int i = 0; i < 2; ++i) static_cast<void>(simulator.next_scan());
    const Senses before = sensed;
    EXPECT_EQ(before.pose, simulator.pose()) << "at first the correction is the identity";
    const auto expect_moved_by = [&](const Pose2& T_map_odom) {
        const Pose2 pose = compose(T_map_odom, before.pose);
        EXPECT_NEAR(sensed.pose.x, pose.x, 1e-9);
        EXPECT_NEAR(sensed.pose.y, pose.y, 1e-9);
        EXPECT_NEAR(normalize_angle(sensed.pose.yaw - pose.yaw), 0.0, 1e-9);
        ASSERT_EQ(sensed.obstacles.size(), before.obstacles.size());
        for (std::size_t n = 0; n < before.obstacles.size(); ++n) {
            EXPECT_NEAR(norm(sensed.obstacles[n] - transform(T_map_odom, before.obstacles[n])), 0.0, 1e-9);
        }
    };
    for (const Pose2& T_map_odom : {Pose2{1.0, -2.0, 0.5}, Pose2{0.5, 0.0, -0.1}}) {
        simulator.correct(T_map_odom); // the obstacles are of the scan before
        const Scan scan = simulator.next_scan();
        expect_moved_by(T_map_odom);
        EXPECT_EQ(scan.odometry, before.pose) << "what is sent does not change";
        static_cast<void>(simulator.next_scan());
        expect_moved_by(T_map_odom);
    }
}

TEST(Simulator, ScansWithoutPosesInTheMapAreTakenAtTheSamePlaces) {
    const auto make_with = [](Poses poses) {
        SimulatorOptions options{make_room(), *find_laser("reference"), Noise{}, 2};
        options.pose = poses == Poses::kNone ? PoseSent::kTrue : PoseSent::kOdometry;
        options.poses = poses;
        return Simulator(std::move(options), std::make_unique<WallFollower>());
    };
    auto map = make_with(Poses::kMap);
    auto odometry = make_with(Poses::kOdometry);
    auto none = make_with(Poses::kNone);
    for (int i = 0; i < 100; ++i) {
        const Scan with_pose = map.next_scan();
        const Scan with_odometry = odometry.next_scan();
        EXPECT_FALSE(with_odometry.pose);
        EXPECT_EQ(with_odometry.odometry, with_pose.pose) << "it starts at the true start";
        EXPECT_EQ(with_odometry.ranges, with_pose.ranges);
        const Scan without = none.next_scan();
        EXPECT_FALSE(without.pose || without.odometry);
        EXPECT_EQ(without.ranges, with_pose.ranges);
    }
}

TEST(Simulator, OdometryNoiseIsProportionalToItsScale) {
    const auto drift_of = [](double scale) {
        auto simulator = make("room", 2, with_odometry(Noise{.range = 0.0, .beam_angle = 0.0}, scale));
        const Pose2 start = simulator.pose();
        Scan scan;
        for (int i = 0; i < 300; ++i) scan = simulator.next_scan();
        const Pose2 estimated = compose(start, *scan.odometry);
        return std::hypot(estimated.x - scan.pose->x, estimated.y - scan.pose->y);
    };
    EXPECT_LT(drift_of(0.0), 1e-9);
    EXPECT_NEAR(drift_of(0.02) / drift_of(0.01), 2.0, 0.1);
    EXPECT_GT(drift_of(0.01), 1e-5);
}

TEST(Simulator, LaserAndSonarScansAlternateWithEqualStamps) {
    SimulatorOptions options{make_office(), *find_laser("reference"), std::nullopt, 4};
    options.sonar = *find_sonar("ring16");
    Simulator both(std::move(options), std::make_unique<WallFollower>());
    auto alone = make("office", 4);
    for (int i = 0; i < 100; ++i) {
        const Scan scan = both.next_scan();
        EXPECT_EQ(scan, alone.next_scan()) << "the robot steers by its laser";
        const Scan heard = both.next_scan();
        EXPECT_EQ(both.sensor_of(scan)->kind, SensorKind::kLaser);
        EXPECT_EQ(both.sensor_of(heard)->kind, SensorKind::kSonar);
        EXPECT_EQ(heard.stamp, scan.stamp);
        EXPECT_EQ(heard.pose, scan.pose);
        EXPECT_EQ(heard.ranges.size(), 16U);
    }
}

/// Results of one simulated drive.
struct Drive {
    double clearance_min = 10.0; // distance to static obstacles
    double walker_distance_min = 10.0;
    double path_length = 0.0;
    double longest_stay = 0.0; // seconds within 0.5 m
    std::size_t square_metres = 0;
    std::uint64_t collisions = 0;
};

Drive watch(Simulator simulator, const World& world, double seconds) {
    Drive drive;
    std::set<std::pair<int, int>> visited;
    Pose2 last = simulator.pose();
    Pose2 stay = last;
    double stay_since = 0.0;
    const int scans = static_cast<int>(seconds / kScanPeriod);
    for (int i = 0; i < scans; ++i) {
        const Scan scan = simulator.next_scan();
        const Pose2& pose = *scan.pose;
        drive.path_length += std::hypot(pose.x - last.x, pose.y - last.y);
        drive.clearance_min = std::min(drive.clearance_min, clearance(world, {pose.x, pose.y}));
        for (const Walker& walker : simulator.world().walkers) {
            drive.walker_distance_min =
                std::min(drive.walker_distance_min, distance(body_of(walker), {pose.x, pose.y}));
        }
        visited.emplace(static_cast<int>(std::floor(pose.x)), static_cast<int>(std::floor(pose.y)));
        if (std::hypot(pose.x - stay.x, pose.y - stay.y) > 0.5) {
            stay = pose;
            stay_since = scan.stamp;
        }
        drive.longest_stay = std::max(drive.longest_stay, scan.stamp - stay_since);
        last = pose;
    }
    drive.square_metres = visited.size();
    drive.collisions = simulator.collisions();
    return drive;
}

struct Setting {
    const char* world;
    const char* laser;
    bool noisy;
};

void PrintTo(const Setting& setting, std::ostream* out) {
    *out << setting.world << ' ' << setting.laser << (setting.noisy ? " noisy" : "");
}

class WallFollowerTrials : public testing::TestWithParam<Setting> {};

TEST_P(WallFollowerTrials, DrivesThreeMinutesWithoutCollisionOrStandstill) {
    const auto [name, laser, noisy] = GetParam();
    const World world = *find_world(name);
    std::size_t square_metres = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Drive drive = watch(make(name, seed, noisy ? std::optional(Noise{}) : std::nullopt, laser), world, 180.0);
        SCOPED_TRACE(fmt::format("{} seed {}", name, seed));
        EXPECT_EQ(drive.collisions, 0U);
        EXPECT_GT(drive.clearance_min, 0.25);
        EXPECT_LT(drive.longest_stay, 15.0);
        EXPECT_GT(drive.path_length, 45.0);
        EXPECT_GT(drive.square_metres, 10U);
        square_metres += drive.square_metres;
    }
    EXPECT_GT(square_metres / 20, 35U) << "few robots circle in a corner";
}

INSTANTIATE_TEST_SUITE_P(All, WallFollowerTrials,
                         testing::Values(Setting{"room", "reference", false}, Setting{"room", "lidar360", true},
                                         Setting{"office", "reference", false}, Setting{"office", "lidar360", true},
                                         Setting{"hall", "reference", false}, Setting{"hall", "lidar360", true}));

/// Drives three minutes in each world with each seed.
void expect_no_collision_by_sonar(std::uint64_t seeds) {
    for (const char* name : {"room", "office", "hall"}) {
        const World world = *find_world(name);
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            SimulatorOptions options{world, std::nullopt, std::nullopt, seed};
            options.sonar = *find_sonar("ring16");
            const Drive drive = watch(Simulator(std::move(options), std::make_unique<WallFollower>()), world, 180.0);
            EXPECT_EQ(drive.collisions, 0U) << name << ' ' << seed;
            EXPECT_GT(drive.path_length, 30.0) << name << ' ' << seed;
        }
    }
}

/// Drives five minutes with each seed.
void expect_no_walker_touched(std::uint64_t seeds) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Drive drive = watch(make("room_walker", seed), make_room(), 300.0);
        EXPECT_GT(drive.walker_distance_min, kBodyRadius) << seed;
        EXPECT_GT(drive.path_length, 60.0) << seed;
    }
}

TEST(WallFollowerDrives, DrivesThreeMinutesBySonarWithoutCollision) { expect_no_collision_by_sonar(4); }
TEST(WallFollowerDrives, DrivesFiveMinutesWithoutTouchingAWalker) { expect_no_walker_touched(2); }

TEST(WallFollowerSeedTrials, DrivesThreeMinutesBySonarWithoutCollision) { expect_no_collision_by_sonar(20); }
TEST(WallFollowerSeedTrials, DrivesFiveMinutesWithoutTouchingAWalker) { expect_no_walker_touched(10); }

/// Returns the office rooms in the order in which the robot entered them: 0 to 4 in the north, 5 to 9 in the south,
/// each row from the west.
std::vector<int> rooms_entered(Simulator simulator, int scans) {
    std::vector<int> entered;
    bool is_inside = false;
    for (int i = 0; i < scans; ++i) {
        const Pose2 pose = *simulator.next_scan().pose;
        const bool was_inside = std::exchange(is_inside, std::abs(pose.y) > 4.0);
        const int row = pose.y > 0.0 ? 0 : 5;
        if (is_inside && !was_inside) entered.push_back(row + static_cast<int>((pose.x + 15.0) / 6.0));
    }
    return entered;
}

void expect_rooms_entered_once(std::initializer_list<std::uint64_t> seeds) {
    for (const std::uint64_t seed : seeds) {
        for (const bool noisy : {false, true}) {
            const auto rooms = rooms_entered(make("office", seed, noisy ? std::optional(Noise{}) : std::nullopt), 3000);
            EXPECT_GE(rooms.size(), 2U) << seed;
            EXPECT_EQ(std::set(rooms.begin(), rooms.end()).size(), rooms.size()) << "each room is entered once";
        }
    }
}

TEST(WallFollowerDrives, EntersAndLeavesOfficeRoomsThroughTheirDoors) { expect_rooms_entered_once({1}); }

TEST(WallFollowerSeedTrials, EntersAndLeavesOfficeRoomsThroughTheirDoors) { expect_rooms_entered_once({2, 3, 4}); }

TEST(WallFollowerDrives, VisitsEveryOfficeRoomInOrder) {
    const auto rooms = rooms_entered(make("office", 3, Noise{}), 13'000); // the robot starts at a table and leaves it
    ASSERT_GE(rooms.size(), 10U);
    EXPECT_EQ(std::vector(rooms.begin(), rooms.begin() + 10), (std::vector{5, 6, 7, 8, 9, 4, 3, 2, 1, 0}));
}

} // namespace
} // namespace scanloom::sim
