#include "core/localization/estimation_state.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/restored.hpp"
#include "tests/unit/core/localization/estimation_scenarios.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <tuple>
#include <utility>

/// The state of the estimation goes to bytes and back at every moment, and changes no result.
namespace scanloom::localization {
namespace {

using slam::Drive;

/// Expects that everything is equal bit by bit: poses, the poses that maps show, the maps, and what is reported.
void expect_all_equal(LocalizedProjection& a, LocalizedProjection& b) {
    EXPECT_TRUE(are_equal(a.poses(), b.poses()));
    EXPECT_TRUE(state_of(a).bytes == state_of(b).bytes);
    EXPECT_EQ(testing_support::digests_of(a.projection().snapshot()),
              testing_support::digests_of(b.projection().snapshot()));
    const Revision end = a.projection().revision();
    ASSERT_EQ(end, b.projection().revision());
    for (RobotIndex robot = 0; robot < a.projection().robots().size(); ++robot) {
        const auto left = a.localization_of(robot);
        const auto right = b.localization_of(robot);
        EXPECT_EQ(std::tie(left.state, left.inlier_ratio, left.position_sigma, left.yaw_sigma, left.loops,
                           left.corrections, left.mount_yaw_error),
                  std::tie(right.state, right.inlier_ratio, right.position_sigma, right.yaw_sigma, right.loops,
                           right.corrections, right.mount_yaw_error));
        const auto* poses = a.poses().find(robot);
        const auto* others = b.poses().find(robot);
        ASSERT_EQ(poses == nullptr, others == nullptr);
        if (poses == nullptr) continue;
        EXPECT_EQ(poses->location().T_map_robot, others->location().T_map_robot);
        EXPECT_EQ(poses->location().T_map_odom, others->location().T_map_odom);
        EXPECT_EQ(poses->estimator().unmatched_count(), others->estimator().unmatched_count());
        for (const Revision then : {end / 2, end * 3 / 4, end}) {
            const auto before = a.poses().history().at(then);
            const auto other = b.poses().history().at(then);
            for (std::uint64_t seq = 1; seq <= poses->scan_count(); ++seq) {
                ASSERT_EQ(before.find(robot, seq), other.find(robot, seq));
            }
        }
    }
}

struct Scenario {
    const char* name;
    void (*run)(GrowingLog& log);
    bool has_corrections;
    bool has_unlocated;
    bool has_open;
};

class EstimationStates : public testing::TestWithParam<Scenario> {};

TEST_P(EstimationStates, GoThroughBytesWithoutChangingAnyResult) {
    GrowingLog undisturbed(0);
    GetParam().run(undisturbed);
    GrowingLog log(13);
    GetParam().run(log);
    EXPECT_EQ(log.outdated > 0, GetParam().has_corrections);
    EXPECT_EQ(log.unlocated > 0, GetParam().has_unlocated);
    EXPECT_EQ(log.open > 0, GetParam().has_open);
    expect_all_equal(log.maps(), undisturbed.maps());
}

std::string name_of_scenario(const testing::TestParamInfo<Scenario>& tested) { return tested.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Logs, EstimationStates,
    testing::Values(Scenario{"TwoRobots", drive_two_robots, true, true, true},
                    Scenario{"FrozenMap", drive_in_a_frozen_map, true, true, false},
                    Scenario{"SentPoses", follow_a_sender, true, true, true},
                    Scenario{"CompleteMap", look_for_a_place_in_a_complete_map, false, true, false},
                    Scenario{"ImpossibleDistances", drive_with_impossible_distances, true, true, false}),
    name_of_scenario);

INSTANTIATE_TEST_SUITE_P(LogTrials, EstimationStates,
                         testing::Values(Scenario{"Loops", drive_a_lap, true, false, false},
                                         Scenario{"AnotherBuilding", drive_in_another_building, false, true, false},
                                         Scenario{"FarBeyond", drive_far_beyond_a_frozen_map, true, false, false}),
                         name_of_scenario);

/// A change of a byte gives another state, or none. Nothing crashes, and neither does what follows.
TEST(EstimationState, ChangedBytesAreRefusedOrGiveAnotherState) {
    GrowingLog log(0);
    drive_in_a_frozen_map(log);
    const EstimationState state = stored(state_of(log.maps()));
    const auto maps = log.maps().projection().state();
    ASSERT_TRUE(restored(state, maps));
    std::mt19937 random(5);
    std::size_t refused = 0;
    constexpr std::size_t kChanges = 300;
    for (std::size_t n = 0; n < kChanges; ++n) {
        EstimationState changed = state;
        // Half of the changes are in the last tenth, where the members of robots are that are no long lists.
        const std::size_t first = n % 2 == 0 ? 0 : changed.bytes.size() * 9 / 10;
        auto& byte = changed.bytes[first + random() % (changed.bytes.size() - first)];
        byte = static_cast<char>(byte ^ static_cast<char>(1U << random() % 8));
        auto other = restored(changed, maps);
        if (!other) {
            ++refused;
            continue;
        }
        LocalizedProjection again(testing_support::restored(log.maps().projection()), std::move(other->poses),
                                  other->shown, other->announced);
        for (std::size_t k = 900; k < 920; ++k) {
            double work = HUGE_VAL;
            Scan scan = looped().scans[k];
            scan.seq = again.projection().robots()[0].last_seq + 1;
            scan.odometry = looped().odometry[k];
            LogEntry entry = ScanTaken{0, scan};
            static_cast<void>(again.apply(entry, work));
        }
        static_cast<void>(again.poses().history().at(maps.revision / 2));
        static_cast<void>(again.localization_of(0));
    }
    EXPECT_GT(refused, kChanges / 20);
    EXPECT_LT(refused, kChanges) << "bits of coordinates are possible in every combination";
}

TEST(EstimationState, TruncatedBytesAreRefused) {
    GrowingLog log(0);
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < 20; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    EstimationState state = state_of(log.maps());
    const auto maps = log.maps().projection().state();
    while (!state.bytes.empty()) {
        state.bytes.pop_back();
        ASSERT_FALSE(restored(state, maps)) << state.bytes.size() << " bytes";
    }
}

TEST(EstimationState, OfOtherMapsIsRefused) {
    GrowingLog log(0);
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < 20; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    const EstimationState state = state_of(log.maps());
    log.drive(0, looped(), 20, Poses::kOdometry);
    EXPECT_FALSE(restored(state, log.maps().projection().state())) << "a scan more";
    EXPECT_TRUE(restored(state_of(log.maps()), log.maps().projection().state()));
    EstimationState lacking = state_of(log.maps());
    lacking.scans.clear();
    EXPECT_FALSE(restored(lacking, log.maps().projection().state()));
}

/// If this fails because the state has other members, raise kEstimationVersion, and set the number to the new one.
TEST(EstimationState, HasTheLayoutOfItsVersion) {
    GrowingLog log(0);
    Drive drive;
    drive.scans.resize(3);
    for (Scan& scan : drive.scans) scan.ranges.assign(beam_count(drive.laser.angles), 1000);
    drive.odometry.resize(3);
    log.join(0, drive, Poses::kOdometry);
    for (std::size_t n = 0; n < 3; ++n) log.drive(0, drive, n, Poses::kOdometry);
    EXPECT_EQ(kEstimationVersion, 7U);
    EXPECT_EQ(state_of(log.maps()).bytes.size(), 2343U);
}

} // namespace
} // namespace scanloom::localization
