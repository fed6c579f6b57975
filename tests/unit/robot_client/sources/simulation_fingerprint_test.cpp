#include "robot_client/sources/simulated_source.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scanloom::robot {
namespace {

sim::SimulatorOptions office_options() { return {sim::make_office(), *sim::find_laser("reference"), sim::Noise{}, 7}; }

std::string fingerprint(const sim::SimulatorOptions& of) {
    return fingerprint_of(of, "wall_follower", NoReturn::kFree);
}

TEST(SimulationFingerprint, EqualsTheFingerprintOfOlderVersions) {
    EXPECT_EQ(fingerprint(office_options()), "simulation:2c4e8578c71e4392b4c3715a4333a356");
}

TEST(SimulationFingerprint, DependsOnEverythingThatDeterminesScans) {
    std::set<std::string> seen{fingerprint(office_options()),
                               fingerprint_of(office_options(), "another", NoReturn::kFree),
                               fingerprint_of(office_options(), "wall_follower", NoReturn::kDrop)};
    void (*const kChanges[])(sim::SimulatorOptions&) = {
        [](sim::SimulatorOptions& o) { o.world = sim::make_room(); },
        [](sim::SimulatorOptions& o) { o.world.solids.back().x_max += 1e-9; },
        [](sim::SimulatorOptions& o) { o.world.floors.pop_back(); },
        [](sim::SimulatorOptions& o) { o.laser = *sim::find_laser("wide"); },
        [](sim::SimulatorOptions& o) { o.laser->range_max = 4.0; },
        [](sim::SimulatorOptions& o) { o.laser->mount.x = 0.1; },
        [](sim::SimulatorOptions& o) { o.noise.reset(); },
        [](sim::SimulatorOptions& o) { o.noise->odometry_drift = 0.03; },
        [](sim::SimulatorOptions& o) { o.noise->range_uniform = 0.1; },
        [](sim::SimulatorOptions& o) { o.world.walkers = sim::make_room_walker().walkers; },
        [](sim::SimulatorOptions& o) {
            o.start = Pose2{1, 2, 0.5};
        },
        [](sim::SimulatorOptions& o) { o.seed = 8; },
        [](sim::SimulatorOptions& o) { o.sonar = *sim::find_sonar("ring16"); },
        [](sim::SimulatorOptions& o) { o.laser = *sim::find_sonar("ring16"); },
        [](sim::SimulatorOptions& o) {
            o.sonar = *sim::find_sonar("ring16");
            o.sonar->aperture = 0.3;
        },
        [](sim::SimulatorOptions& o) { o.noise = sim::with_odometry(sim::Noise{}, 2.0); },
        [](sim::SimulatorOptions& o) { o.pose = sim::PoseSent::kOdometry; },
        [](sim::SimulatorOptions& o) {
            o.world.unknown = {{1, 2, 3, 4}};
        },
        [](sim::SimulatorOptions& o) {
            o.world.starts = {{1, 2, 3, 4}};
        },
        [](sim::SimulatorOptions& o) { o.world.start_clearance = 0.3; },
    };
    for (const auto change : kChanges) {
        sim::SimulatorOptions changed = office_options();
        change(changed);
        seen.insert(fingerprint(changed));
    }
    EXPECT_EQ(seen.size(), 3 + std::size(kChanges));
}

} // namespace
} // namespace scanloom::robot
