#include "sim/robot/simulated_source.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scanloom::sim {
namespace {

SimulatorOptions office_options() { return {make_office(), *find_laser("reference"), Noise{}, 7}; }

std::string fingerprint(const SimulatorOptions& of) {
    return fingerprint_of(of, "wall_follower", robot::NoReturn::kFree);
}

TEST(SimulationFingerprint, EqualsTheFingerprintOfOlderVersions) {
    EXPECT_EQ(fingerprint(office_options()), "simulation:2c4e8578c71e4392b4c3715a4333a356");
}

TEST(SimulationFingerprint, DependsOnEverythingThatDeterminesScans) {
    std::set<std::string> seen{fingerprint(office_options()),
                               fingerprint_of(office_options(), "another", robot::NoReturn::kFree),
                               fingerprint_of(office_options(), "wall_follower", robot::NoReturn::kDrop)};
    void (*const kChanges[])(SimulatorOptions&) = {
        [](SimulatorOptions& o) { o.world = make_room(); },
        [](SimulatorOptions& o) { o.world.solids.back().x_max += 1e-9; },
        [](SimulatorOptions& o) { o.world.floors.pop_back(); },
        [](SimulatorOptions& o) { o.laser = *find_laser("wide"); },
        [](SimulatorOptions& o) { o.laser->range_max = 4.0; },
        [](SimulatorOptions& o) { o.is_carried = true; },
        [](SimulatorOptions& o) { o.laser->mount.x = 0.1; },
        [](SimulatorOptions& o) { o.noise.reset(); },
        [](SimulatorOptions& o) { o.noise->odometry_drift = 0.03; },
        [](SimulatorOptions& o) { o.noise->range_uniform = 0.1; },
        [](SimulatorOptions& o) { o.world.walkers = make_room_walker().walkers; },
        [](SimulatorOptions& o) {
            o.start = Pose2{1, 2, 0.5};
        },
        [](SimulatorOptions& o) { o.seed = 8; },
        [](SimulatorOptions& o) { o.sonar = *find_sonar("ring16"); },
        [](SimulatorOptions& o) { o.laser = *find_sonar("ring16"); },
        [](SimulatorOptions& o) {
            o.sonar = *find_sonar("ring16");
            o.sonar->aperture = 0.3;
        },
        [](SimulatorOptions& o) { o.noise = with_odometry(Noise{}, 2.0); },
        [](SimulatorOptions& o) { o.pose = PoseSent::kOdometry; },
        [](SimulatorOptions& o) { o.poses = Poses::kOdometry; },
        [](SimulatorOptions& o) { o.poses = Poses::kNone; },
        [](SimulatorOptions& o) {
            o.world.unknown = {{1, 2, 3, 4}};
        },
        [](SimulatorOptions& o) {
            o.world.starts = {{1, 2, 3, 4}};
        },
        [](SimulatorOptions& o) { o.world.start_clearance = 0.3; },
    };
    for (const auto change : kChanges) {
        SimulatorOptions changed = office_options();
        change(changed);
        seen.insert(fingerprint(changed));
    }
    EXPECT_EQ(seen.size(), 3 + std::size(kChanges));
}

} // namespace
} // namespace scanloom::sim
