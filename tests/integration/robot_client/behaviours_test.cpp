#include "sim/drive/wall_follower.hpp"
#include "sim/drive/waypoints.hpp"
#include "sim/drive/zigzag.hpp"
#include "sim/ground_truth.hpp"
#include "sim/simulator.hpp"
#include "sim/world.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

/// Every behaviour in every world, from twenty start places.
namespace scanloom::robot {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kSeedsPerDriveCase = 5; // so that cases can run in parallel

std::unique_ptr<sim::Behaviour> wall_follower(const sim::World&) { return std::make_unique<sim::WallFollower>(); }

std::unique_ptr<sim::Behaviour> waypoints(const sim::World& world) {
    return std::make_unique<sim::Waypoints>(sim::tour_of(world.name), sim::TourStart::kNearest);
}

std::unique_ptr<sim::Behaviour> zigzag(const sim::World& world) {
    return std::make_unique<sim::Zigzag>(floor_plan_of(ground_truth_of(world, 0.05)));
}

struct Drive {
    const char* name;
    std::unique_ptr<sim::Behaviour> (*make)(const sim::World&);
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

struct DriveCase {
    Drive drive;
    sim::NamedWorld world;
    const char* laser;
    bool noisy;
    std::uint64_t first_seed;

    friend void PrintTo(const DriveCase& one, std::ostream* out) {
        *out << fmt::format("{}_{}_{}{}_from_{}", one.drive.name, one.world.name, one.laser, one.noisy ? "_noisy" : "",
                            one.first_seed);
    }
};

std::vector<DriveCase> drive_cases() {
    std::vector<DriveCase> cases;
    for (const Drive& drive : kDrives) {
        for (const sim::NamedWorld& world : sim::kWorlds) {
            for (std::uint64_t seed = 1; seed <= 20; seed += kSeedsPerDriveCase) {
                cases.push_back({drive, world, "reference", false, seed});
            }
            cases.push_back({drive, world, "reference", true, 1});
            cases.push_back({drive, world, "lidar360", true, 6});
        }
    }
    return cases;
}

class Behaviours : public testing::TestWithParam<DriveCase> {};

bool is_room(const sim::World& world) { return world.name.starts_with("room"); }

/// Further checks of behaviours that end.
void expect_of(const sim::Behaviour& behaviour, const sim::World& world) {
    if (const auto* tour = dynamic_cast<const sim::Waypoints*>(&behaviour)) {
        EXPECT_TRUE(tour->is_done());
        EXPECT_GE(static_cast<double>(tour->reached()), 0.9 * static_cast<double>(sim::tour_of(world.name).size()));
    }
    if (const auto* sweep = dynamic_cast<const sim::Zigzag*>(&behaviour)) {
        EXPECT_EQ(sweep->is_done(), is_room(world));
        if (is_room(world)) {
            EXPECT_GT(sweep->coverage(), world.walkers.empty() ? 0.95 : 0.9);
        }
        if (world.walkers.empty()) {
            EXPECT_THAT(sweep->remarks(), Not(AnyOf(HasSubstr("lanes abandoned"), HasSubstr("detours"))));
        }
    }
}

TEST_P(Behaviours, DriveWithoutCollisionsAndMakeProgress) {
    const auto [drive, named, laser, noisy, first_seed] = GetParam();
    const sim::World world = named.make();
    for (std::uint64_t seed = first_seed; seed < first_seed + kSeedsPerDriveCase; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        sim::Simulator simulator(
            {world, *sim::find_laser(laser), noisy ? std::optional(sim::Noise{}) : std::nullopt, seed},
            drive.make(world));
        Pose2 last = *simulator.next_scan().pose;
        double metres = 0.0;
        double clearance_min = 10.0;
        const bool is_cut = drive.make == zigzag && !is_room(world);
        const double seconds = is_cut ? kLargeSweep : drive.seconds;
        for (double time = 0.0; time < seconds && !simulator.behaviour().is_done(); time += sim::kScanPeriod) {
            const Pose2 pose = *simulator.next_scan().pose;
            metres += std::hypot(pose.x - last.x, pose.y - last.y);
            last = pose;
            clearance_min = std::min(clearance_min, clearance(simulator.world(), {pose.x, pose.y}));
        }
        EXPECT_EQ(simulator.collisions(), 0U);
        EXPECT_GE(clearance_min, sim::kBodyRadius);
        EXPECT_GT(metres, drive.metres);
        expect_of(simulator.behaviour(), world);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Behaviours, testing::ValuesIn(drive_cases()),
                         [](const auto& one) { return testing::PrintToString(one.param); });

TEST(Behaviours, ASweepOfTheOfficeEndsAndCoversMostOfIt) {
    const sim::World office = sim::make_office();
    sim::Simulator simulator({office, *sim::find_laser("reference"), std::nullopt, 1}, zigzag(office));
    for (double time = 0.0; time < 6000.0 && !simulator.behaviour().is_done(); time += sim::kScanPeriod) {
        static_cast<void>(simulator.next_scan());
    }
    const auto& sweep = dynamic_cast<const sim::Zigzag&>(simulator.behaviour());
    EXPECT_TRUE(sweep.is_done());
    EXPECT_GT(sweep.coverage(), 0.95);
    EXPECT_THAT(sweep.remarks(), Not(HasSubstr("lanes abandoned")));
    EXPECT_EQ(simulator.collisions(), 0U);
}

TEST(Behaviours, TheSameSeedGivesTheSameDrive) {
    const sim::World world = sim::make_room_walker();
    for (const Drive& drive : kDrives) {
        const auto scans = [&] {
            sim::Simulator simulator({world, *sim::find_laser("reference"), sim::Noise{}, 3}, drive.make(world));
            std::vector<Scan> taken;
            for (int n = 0; n < 1500; ++n) taken.push_back(simulator.next_scan());
            return taken;
        };
        EXPECT_EQ(scans(), scans()) << drive.name;
    }
}

} // namespace
} // namespace scanloom::robot
