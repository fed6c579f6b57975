#include "sim/drive/wall_follower.hpp"
#include "sim/drive/waypoints.hpp"
#include "sim/drive/zigzag.hpp"
#include "sim/ground_truth.hpp"
#include "sim/simulator.hpp"
#include "sim/world.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

/// Every behaviour in every world, from twenty start places.
namespace scanloom::robot {
namespace {

constexpr std::uint64_t kSeedsPerCase = 5; // so that cases can run in parallel

std::unique_ptr<Behaviour> wall_follower(const World&) { return std::make_unique<WallFollower>(); }

std::unique_ptr<Behaviour> waypoints(const World& world) {
    return std::make_unique<Waypoints>(tour_of(world.name), TourStart::kNearest);
}

std::unique_ptr<Behaviour> zigzag(const World& world) {
    return std::make_unique<Zigzag>(floor_plan_of(truth_of(world, 0.05)));
}

struct Drive {
    const char* name;
    std::unique_ptr<Behaviour> (*make)(const World&);
    double seconds; // upper limit
    double metres;  // lower limit of the driven distance
};

// Tours end before that, and so do sweeps of the rooms; the rest of a larger sweep tests nothing new.
const std::vector<Drive> kDrives{
    {"wall_follower", wall_follower, 180.0, 40.0},
    {"waypoints", waypoints, 1800.0, 20.0},
    {"zigzag", zigzag, 1000.0, 100.0},
};
constexpr double kLargeSweep = 400.0; // seconds

struct Case {
    Drive drive;
    NamedWorld world;
    const char* laser;
    bool noisy;
    std::uint64_t first_seed;

    friend void PrintTo(const Case& one, std::ostream* out) {
        *out << fmt::format("{}_{}_{}{}_from_{}", one.drive.name, one.world.name, one.laser, one.noisy ? "_noisy" : "",
                            one.first_seed);
    }
};

std::vector<Case> cases() {
    std::vector<Case> cases;
    for (const Drive& drive : kDrives) {
        for (const NamedWorld& world : kWorlds) {
            for (std::uint64_t seed = 1; seed <= 20; seed += kSeedsPerCase) {
                cases.push_back({drive, world, "reference", false, seed});
            }
            cases.push_back({drive, world, "reference", true, 1});
            cases.push_back({drive, world, "lidar360", true, 6});
        }
    }
    return cases;
}

class Behaviours : public testing::TestWithParam<Case> {};

bool is_room(const World& world) { return world.name.starts_with("room"); }

/// Further checks of behaviours that end.
void expect_of(const Behaviour& behaviour, const World& world) {
    if (const auto* tour = dynamic_cast<const Waypoints*>(&behaviour)) {
        EXPECT_TRUE(tour->is_done());
        EXPECT_GE(static_cast<double>(tour->reached()), 0.9 * static_cast<double>(tour_of(world.name).size()));
    }
    if (const auto* sweep = dynamic_cast<const Zigzag*>(&behaviour)) {
        EXPECT_EQ(sweep->is_done(), is_room(world));
        if (is_room(world)) {
            EXPECT_GT(sweep->coverage(), world.walkers.empty() ? 0.95 : 0.9);
        }
        if (world.walkers.empty()) {
            EXPECT_EQ(sweep->lanes_given_up() + sweep->detours(), 0);
        }
    }
}

TEST_P(Behaviours, DriveWithoutCollisionsAndMakeProgress) {
    const auto [drive, named, laser, noisy, first_seed] = GetParam();
    const World world = named.make();
    for (std::uint64_t seed = first_seed; seed < first_seed + kSeedsPerCase; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Simulator simulator({world, *find_laser(laser), noisy ? std::optional(Noise{}) : std::nullopt, seed},
                            drive.make(world));
        Pose2 last = simulator.next_scan().pose;
        double metres = 0.0;
        double clearance_min = 10.0;
        const bool is_cut = drive.make == zigzag && !is_room(world);
        const double seconds = is_cut ? kLargeSweep : drive.seconds;
        for (double time = 0.0; time < seconds && !simulator.behaviour().is_done(); time += kScanPeriod) {
            const Pose2 pose = simulator.next_scan().pose;
            metres += std::hypot(pose.x - last.x, pose.y - last.y);
            last = pose;
            clearance_min = std::min(clearance_min, clearance(simulator.world(), {pose.x, pose.y}));
        }
        EXPECT_EQ(simulator.collisions(), 0U);
        EXPECT_GE(clearance_min, kBodyRadius);
        EXPECT_GT(metres, drive.metres);
        expect_of(simulator.behaviour(), world);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Behaviours, testing::ValuesIn(cases()),
                         [](const auto& one) { return testing::PrintToString(one.param); });

TEST(Behaviours, ASweepOfTheOfficeEndsAndCoversMostOfIt) {
    const World office = make_office();
    Simulator simulator({office, *find_laser("reference"), std::nullopt, 1}, zigzag(office));
    for (double time = 0.0; time < 6000.0 && !simulator.behaviour().is_done(); time += kScanPeriod) {
        static_cast<void>(simulator.next_scan());
    }
    const auto& sweep = dynamic_cast<const Zigzag&>(simulator.behaviour());
    EXPECT_TRUE(sweep.is_done());
    EXPECT_GT(sweep.coverage(), 0.95);
    EXPECT_EQ(sweep.lanes_given_up(), 0);
    EXPECT_EQ(simulator.collisions(), 0U);
}

TEST(Behaviours, TheSameSeedGivesTheSameDrive) {
    const World world = make_room_walker();
    for (const Drive& drive : kDrives) {
        const auto scans = [&] {
            Simulator simulator({world, *find_laser("reference"), Noise{}, 3}, drive.make(world));
            std::vector<Scan> taken;
            for (int n = 0; n < 1500; ++n) taken.push_back(simulator.next_scan());
            return taken;
        };
        EXPECT_EQ(scans(), scans()) << drive.name;
    }
}

} // namespace
} // namespace scanloom::robot
