#include "core/localization/estimation_state.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/restored.hpp"
#include "tests/unit/core/localization/two_robots_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

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

/// Returns the state after its way through bytes.
EstimationState stored(const EstimationState& state) {
    EstimationState read{state.bytes, {}, {}, {}};
    std::string scans;
    for (const auto& scan : state.scans) scans += bytes_of(*scan);
    EXPECT_TRUE(append_scans(scans, read.scans));
    for (const auto& each : state.corrections) EXPECT_TRUE(append_correction(bytes_of(*each), read.corrections));
    return read;
}

/// Returns the maps that a checkpoint of these would give.
std::optional<LocalizedProjection> through_bytes(LocalizedProjection& maps) {
    const auto state = maps.projection().state();
    auto estimation = restored(stored(state_of(maps)), state);
    if (!estimation) return std::nullopt;
    for (std::size_t n = 0; n < state.robots.size(); ++n) {
        const auto poses = estimation->robots[n].poses.snapshot();
        EXPECT_EQ(poses.size(), state.robots[n].scan_poses.size());
        for (std::size_t k = 0; k < poses.size(); ++k) EXPECT_EQ(poses[k], state.robots[n].scan_poses[k]);
        EXPECT_EQ(estimation->robots[n].turns, state.robots[n].turns);
    }
    EXPECT_EQ(estimation->corrected, state.corrected);
    return LocalizedProjection(testing_support::restored(maps.projection()), std::move(estimation->poses),
                               estimation->shown, estimation->announced);
}

/// A log that grows, and its maps.
class GrowingLog {
public:
    /// @param every  scans between two ways through bytes, of which one also follows each other entry; 0: none
    explicit GrowingLog(std::size_t every) : every_(every) {}

    void add(LogEntry entry) {
        log_.push_back(entry);
        double work = HUGE_VAL;
        ASSERT_TRUE(maps_->apply(entry, work).value());
        if (std::holds_alternative<MapsCorrected>(entry)) show_corrected();
        const bool is_scan = std::holds_alternative<ScanTaken>(entry);
        if (every_ == 0 || (is_scan && log_.size() % every_ != 0)) return;
        look();
        auto again = through_bytes(*maps_);
        ASSERT_TRUE(again);
        maps_.emplace(std::move(*again));
    }

    void join(RobotIndex robot, const Drive& drive, Poses poses) {
        add(RobotJoined{robot, "robot " + std::to_string(robot), {}, {}, poses});
        add(SensorDescribed{robot, drive.laser});
    }

    /// Adds a scan. The maps are corrected 30 entries after it is due.
    void drive(RobotIndex robot, const Drive& drive, std::size_t n, Poses poses) {
        Scan scan = drive.scans[n];
        scan.seq = maps_->projection().robots()[robot].last_seq + 1;
        scan.stamp = 0.1 * static_cast<double>(scan.seq);
        if (n % 2 == 0) scan.duration = 0.05;
        scan.pose.reset();
        if (poses == Poses::kMap) scan.pose = compose(inverse(drive.truth.front()), drive.truth[n]);
        if (poses == Poses::kOdometry) scan.odometry = drive.odometry[n];
        add(ScanTaken{robot, scan, maps_->projection().is_localize_only()});
        if (!maps_->is_outdated()) {
            outdated_ = 0;
        } else if (++outdated_ > 30) {
            add(MapsCorrected{maps_->poses().corrected()});
        }
    }

    [[nodiscard]] LocalizedProjection& maps() { return *maps_; }

    // Number of ways through bytes at special moments.
    std::size_t open = 0;      // scans of which are not decided
    std::size_t unlocated = 0; // robots that are not located
    std::size_t outdated = 0;  // maps that are to be corrected

private:
    void look() {
        outdated += maps_->is_outdated() ? 1 : 0;
        for (RobotIndex robot = 0; robot < maps_->projection().robots().size(); ++robot) {
            const auto* poses = maps_->poses().find(robot);
            if (poses == nullptr) continue;
            open += poses->estimator().decided_count() < poses->estimator().scan_count() ? 1 : 0;
            unlocated += poses->localization().state == LocalizationState::kUnlocated ? 1 : 0;
        }
    }

    void show_corrected() {
        const auto poses = maps_->poses().in_maps();
        mapping::Projection corrected(maps_->projection().config());
        for (LogEntry entry : log_) {
            poses.place(entry);
            ASSERT_TRUE(corrected.apply(entry));
        }
        maps_->replace(std::move(corrected), maps_->poses().corrected());
    }

    std::size_t every_;
    std::size_t outdated_ = 0; // scans since the maps are
    std::vector<LogEntry> log_;
    std::optional<LocalizedProjection> maps_{mapping::Projection(mapping::resolve({.cell_size = 0.1}).value())};
};

const Drive& looped() {
    static const Drive drive =
        slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    return drive;
}

const Drive& back() {
    static const Drive drive = slam::drive_along(
        slam::ring_building(), std::vector<Point2>{{24.0, 21.0}, {1.0, 21.0}, {1.0, 8.0}}, {.scale = 0.98}, 2);
    return drive;
}

/// Loops, which correct the maps.
void drive_a_lap(GrowingLog& log) {
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < looped().scans.size(); ++n) log.drive(0, looped(), n, Poses::kOdometry);
}

/// Two robots: one without odometry that also has sonars, and one that starts elsewhere, sees nothing for a while, and
/// is lost then.
void drive_two_robots(GrowingLog& log) {
    Sensor sonar;
    sonar.id = 7;
    sonar.kind = SensorKind::kSonar;
    sonar.range_max = 3.0;
    sonar.aperture = 0.4;
    sonar.angles = UniformAngles{0.0, 0.1, 1};
    Drive readings = looped();
    for (Scan& scan : readings.scans) {
        scan.sensor = 7;
        scan.ranges = {1000};
    }
    log.join(0, looped(), Poses::kNone);
    log.add(SensorDescribed{0, sonar});
    for (std::size_t n = 0; n < 900; ++n) {
        log.drive(0, looped(), n, Poses::kNone);
        if (n % 3 == 0) log.drive(0, readings, n, Poses::kNone);
    }
    log.join(1, back(), Poses::kOdometry);
    Drive blind = back();
    for (Scan& scan : blind.scans) std::ranges::fill(scan.ranges, kNoReturn);
    for (std::size_t n = 0; n < back().scans.size(); ++n) {
        log.drive(0, looped(), 900 + n % 200, Poses::kNone);
        log.drive(1, n > 250 && n < 290 ? blind : back(), n, Poses::kOdometry);
    }
}

/// Localize-only mode while a robot goes on beyond the map, a robot that an operator looks for, and mapping afterwards.
void drive_in_a_frozen_map(GrowingLog& log) {
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < 400; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    log.add(ModeChanged{true});
    for (std::size_t n = 400; n < 700; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    log.join(1, looped(), Poses::kOdometry);
    for (std::size_t n = 200; n < 300; ++n) {
        if (n == 203 || n == 270) {
            const Pose2 truth = compose(inverse(looped().truth.front()), looped().truth[n]);
            log.add(RobotRelocalized{1, {truth.x + 1.0, truth.y}, 4.0});
        }
        log.drive(1, looped(), n, Poses::kOdometry);
    }
    log.add(ModeChanged{false});
    for (std::size_t n = 700; n < 900; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    for (std::size_t n = 300; n < 400; ++n) log.drive(1, looped(), n, Poses::kOdometry);
}

/// A robot that is located in the map of one that sends its poses.
void follow_a_sender(GrowingLog& log) {
    log.join(0, looped(), Poses::kMap);
    for (std::size_t n = 0; n < 700; ++n) log.drive(0, looped(), n, Poses::kMap);
    log.join(1, looped(), Poses::kNone);
    for (std::size_t n = 700; n < 1000; ++n) {
        log.drive(0, looped(), n, Poses::kMap);
        log.drive(1, looped(), n - 500, Poses::kNone);
        if (n == 900) log.join(2, looped(), Poses::kMap);
        if (n > 900) log.drive(2, looped(), n - 600, Poses::kMap);
    }
}

/// A robot with a wrong mount that is located in a map that does not change, of one that sends its poses.
void look_for_a_place_in_a_complete_map(GrowingLog& log) {
    log.join(0, looped(), Poses::kMap);
    for (std::size_t n = 0; n < 700; ++n) log.drive(0, looped(), n, Poses::kMap);
    log.add(ModeChanged{true});
    Drive turned = looped();
    turned.laser.mount.yaw = 0.6; // it is 0
    log.join(1, turned, Poses::kOdometry);
    for (std::size_t n = 200; n < 350; ++n) log.drive(1, turned, n, Poses::kOdometry);
    EXPECT_TRUE(log.maps().localization_of(1).mount_yaw_error);
}

/// A robot in another building, where a search of its place takes several parts.
void drive_in_another_building(GrowingLog& log) {
    testing_support::Building other;
    other.add_box(0.0, 0.0, 14.0, 9.0);
    other.add_box(3.0, 3.0, 5.0, 4.5);
    other.add_box(8.0, 5.0, 11.0, 6.0);
    const Drive drive = slam::drive_along(
        other, std::vector<Point2>{{1.0, 1.0}, {13.0, 1.5}, {13.0, 8.0}, {6.0, 7.5}, {1.5, 8.0}, {1.0, 2.0}}, {}, 5);
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < looped().scans.size(); n += 2) log.drive(0, looped(), n, Poses::kOdometry);
    log.join(1, drive, Poses::kOdometry);
    for (std::size_t n = 0; n < 100; ++n) log.drive(1, drive, n, Poses::kOdometry);
}

/// A straight corridor whose posts are the same in every 30 m, with exact odometry.
Drive corridor(double length) {
    constexpr double kPeriod = 30.0;
    testing_support::Building part; // all that is seen from its first period
    part.walls = {{{-40.0, -1.0}, {70.0, -1.0}}, {{-40.0, 1.5}, {70.0, 1.5}}};
    for (const double at : {2.0, 4.7, 9.1, 11.9, 18.3, 21.4, 25.8}) {
        for (const double shift : {-kPeriod, 0.0, kPeriod}) part.add_box(at + shift, -1.0, at + shift + 0.5, -0.6);
    }
    Drive drive;
    std::mt19937 random(6);
    for (double at = 0.0; at < length; at += 0.5) {
        drive.truth.push_back({at, 0.0, 0.0});
        drive.odometry.push_back({at, 0.0, 0.0});
        drive.scans.push_back(part.scan(drive.laser, {std::fmod(at, kPeriod), 0.0, 0.0}, 0.01, random));
    }
    return drive;
}

/// A robot that goes on for more than a kilometre beyond a map that does not change, by what it sees itself.
void drive_far_beyond_a_frozen_map(GrowingLog& log) {
    static const Drive drive = corridor(1300.0);
    log.join(0, drive, Poses::kOdometry);
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        if (n == 100) log.add(ModeChanged{true});
        log.drive(0, drive, n, Poses::kOdometry);
    }
    EXPECT_EQ(log.maps().localization_of(0).state, LocalizationState::kTracking);
    EXPECT_NEAR(log.maps().poses().find(0)->location().T_map_robot.x, drive.truth.back().x, 5.0);
}

/// A sender that is wrong by kilometres now and then, a robot that is located in its map, and lasers that are too far
/// from their robots.
void drive_with_impossible_distances(GrowingLog& log) {
    Drive jumping = looped();
    for (std::size_t n = 50; n < jumping.truth.size(); n += 100) jumping.truth[n].x += 1500.0;
    log.join(0, jumping, Poses::kMap);
    for (std::size_t n = 0; n < 20; ++n) log.drive(0, jumping, n, Poses::kMap);
    log.join(1, looped(), Poses::kOdometry);
    for (std::size_t n = 20; n < 700; ++n) {
        log.drive(0, jumping, n, Poses::kMap);
        if (n >= 300 && n < 600) log.drive(1, looped(), n - 100, Poses::kOdometry);
    }
    EXPECT_EQ(log.maps().localization_of(1).state, LocalizationState::kTracking);
    Drive far = looped();
    far.laser.mount = {1200.0, 0.0, 0.0};
    log.join(2, far, Poses::kOdometry);
    log.join(3, far, Poses::kMap);
    for (std::size_t n = 0; n < 60; ++n) {
        log.drive(2, far, n, Poses::kOdometry);
        log.drive(3, far, n, Poses::kMap);
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

INSTANTIATE_TEST_SUITE_P(
    Logs, EstimationStates,
    testing::Values(Scenario{"Loops", drive_a_lap, true, false, false},
                    Scenario{"TwoRobots", drive_two_robots, true, true, true},
                    Scenario{"FrozenMap", drive_in_a_frozen_map, true, true, false},
                    Scenario{"AnotherBuilding", drive_in_another_building, false, true, false},
                    Scenario{"SentPoses", follow_a_sender, true, true, false},
                    Scenario{"CompleteMap", look_for_a_place_in_a_complete_map, false, true, false},
                    Scenario{"FarBeyond", drive_far_beyond_a_frozen_map, true, false, false},
                    Scenario{"ImpossibleDistances", drive_with_impossible_distances, true, true, true}),
    [](const auto& scenario) { return std::string(scenario.param.name); });

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
    EXPECT_EQ(kEstimationVersion, 3U);
    EXPECT_EQ(state_of(log.maps()).bytes.size(), 1595U);
}

} // namespace
} // namespace scanloom::localization
