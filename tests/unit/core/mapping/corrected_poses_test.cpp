#include "core/mapping/projection.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/random_scans.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::mapping {
namespace {

using testing_support::digests_of;
using testing_support::random_scan;
using testing_support::small_laser;

Sensor ring_of_sonars() {
    Sensor sensor;
    sensor.id = 3;
    sensor.kind = SensorKind::kSonar;
    sensor.angles = UniformAngles{-std::numbers::pi, 2 * std::numbers::pi / 8, 8};
    sensor.aperture = 0.5;
    sensor.range_max = 3.0;
    return sensor;
}

/// Returns a log in which every fourth scan is of a ring of sonars and the others are of a laser. The scans have no
/// poses; the last entry says that the maps were corrected.
std::vector<LogEntry> log_without_poses(unsigned seed, std::size_t scans) {
    std::vector<LogEntry> log{RobotJoined{.robot = 0, .name = "r", .poses = Poses::kOdometry},
                              SensorDescribed{0, small_laser()}, SensorDescribed{0, ring_of_sonars()}};
    for (std::uint64_t seq = 1; seq <= scans; ++seq) {
        Scan scan = random_scan(seed, seq);
        scan.pose.reset();
        if (seq % 4 == 0) {
            scan.sensor = ring_of_sonars().id;
            scan.ranges.resize(8);
        }
        log.push_back(ScanTaken{0, std::move(scan)});
    }
    log.push_back(MapsCorrected{log.size()});
    return log;
}

/// The pose of each scan; nullopt: it has none.
using Places = std::vector<std::optional<Pose2>>;

Places random_places(std::mt19937& random, std::size_t scans) {
    std::uniform_real_distribution<double> metres(-8.0, 8.0);
    Places places(scans);
    for (auto& place : places) {
        if (random() % 10 != 0) place = Pose2{metres(random), metres(random), normalize_angle(metres(random))};
    }
    return places;
}

/// Moves some of the scans, finds places for some that had none and loses those of others.
Places moved(std::mt19937& random, Places places) {
    const auto others = random_places(random, places.size());
    for (std::size_t n = 0; n < places.size(); ++n) {
        if (random() % 3 == 0) places[n] = others[n];
    }
    return places;
}

ScanPoses scan_poses(const Places& places) {
    EstimatedPoses poses;
    for (const auto& place : places) poses.append(place);
    return ScanPoses({poses.snapshot()}, 17);
}

void apply(Projection& projection, std::vector<LogEntry> log, const Places& places) {
    const auto poses = scan_poses(places);
    for (auto& entry : log) {
        poses.place(entry);
        projection.apply(entry).value();
    }
}

TEST(ScanPoses, FindsThePosesOfTheScansThatHaveOne) {
    const auto poses = scan_poses({Pose2{1.0, 2.0, 0.5}, std::nullopt});
    EXPECT_EQ(poses.find(0, 1), (Pose2{1.0, 2.0, 0.5}));
    EXPECT_EQ(poses.find(0, 2), std::nullopt);
    EXPECT_EQ(poses.find(0, 3), std::nullopt) << "not taken yet";
    EXPECT_EQ(poses.find(0, 0), std::nullopt) << "no scan has this number";
    EXPECT_EQ(poses.find(1, 1), std::nullopt) << "another robot";
    EXPECT_EQ(poses.corrected(), 17U);
    EXPECT_EQ(ScanPoses().find(0, 1), std::nullopt);
    EXPECT_EQ(ScanPoses().corrected(), 0U);
}

TEST(ScanPoses, PlacesOnlyScansWithoutAPose) {
    const auto poses = scan_poses({Pose2{1.0, 2.0, 0.5}, std::nullopt});
    for (const std::uint64_t seq : {1U, 2U}) {
        ScanPose scan{0, seq, 0.0, std::nullopt};
        poses.place(scan);
        EXPECT_EQ(scan.pose, poses.find(0, seq));
        ScanPose sent{0, seq, 0.0, Pose2{3.0, 3.0, 0.0}};
        poses.place(sent);
        EXPECT_EQ(sent.pose, (Pose2{3.0, 3.0, 0.0}));

        Scan without = random_scan(1, seq);
        without.pose.reset();
        LogEntry entry = ScanTaken{0, without};
        poses.place(entry);
        EXPECT_EQ(std::get<ScanTaken>(entry).scan.pose, poses.find(0, seq));
        const LogEntry with = ScanTaken{0, random_scan(1, seq)};
        entry = with;
        poses.place(entry);
        EXPECT_EQ(entry, with);
    }
    LogEntry joined = RobotJoined{0, "r"};
    poses.place(joined);
    EXPECT_EQ(joined, LogEntry(RobotJoined{0, "r"}));
}

TEST(Projection, ScanWithoutAPoseIsCountedAndLeftOut) {
    Projection projection{MapConfig{}};
    const Places places{std::nullopt, Pose2{1.0, 0.0, 0.0}, std::nullopt, std::nullopt};
    auto log = log_without_poses(1, places.size());
    log.pop_back();
    apply(projection, {log.begin(), log.begin() + 4}, places);
    EXPECT_TRUE(projection.has_left_out_newest(0));
    EXPECT_EQ(projection.chunk_count(), 0U);
    apply(projection, {log.begin() + 4, log.end()}, places);
    const auto robot = projection.snapshot().robots.at(0);
    EXPECT_EQ(robot.poses, Poses::kOdometry);
    EXPECT_EQ(robot.last_seq, 4U);
    EXPECT_EQ(robot.unplaced, 3U);
    EXPECT_EQ(robot.scan_count, 1U);
    EXPECT_EQ(robot.excluded + robot.jumps, 0U);
    EXPECT_EQ(robot.pose, places[1]);
    EXPECT_EQ(robot.trajectory.size(), 1U);
    for (std::uint64_t seq = 1; seq <= 4; ++seq) {
        EXPECT_EQ(projection.snapshot().scan_poses.find(0, seq), places[seq - 1]) << seq;
    }
    EXPECT_TRUE(projection.has_estimated_poses());
}

TEST(Projection, PosesThatRobotsSendAreNotKeptAsEstimated) {
    Projection projection{MapConfig{}};
    for (const LogEntry& entry : {LogEntry(RobotJoined{0, "r"}), LogEntry(SensorDescribed{0, small_laser()}),
                                  LogEntry(ScanTaken{0, random_scan(1, 1)})}) {
        ASSERT_TRUE(projection.apply(entry));
    }
    EXPECT_EQ(projection.snapshot().scan_poses.find(0, 1), std::nullopt);
    EXPECT_FALSE(projection.has_estimated_poses());
}

/// Expects that the chunks of `after` that differ from those of `before` have this revision, and the others an older
/// one.
/// @return the number of chunks that are in `before` and blank in `after`
template <class View, class IsSame>
std::size_t expect_changes_at(Revision revision, const View& before, const View& after, const View& wanted,
                              IsSame is_same) {
    std::size_t blank = 0;
    after.visit({}, 0, [&](grid::ChunkKey key, const auto& chunk) {
        const auto* old = before.find(key);
        const bool is_kept = old != nullptr && is_same(*old, chunk);
        EXPECT_EQ(chunk.revision == revision, !is_kept);
        EXPECT_LE(chunk.revision, revision);
        if (wanted.find(key) == nullptr) ++blank;
    });
    return blank;
}

/// What became blank when maps were replaced.
struct Blanked {
    std::size_t chunks = 0;  ///< of the laser and sonar layers
    std::size_t classes = 0; ///< chunks of the classes
};

/// Replaces the maps of random scans by those with some of the scans moved, and compares with maps made from scratch.
Blanked replace_random_maps(const MapConfig& config, unsigned seed) {
    std::mt19937 random(seed);
    constexpr std::size_t kScans = 24;
    constexpr std::size_t kStray = 5;
    const auto log = log_without_poses(seed, kScans);
    auto places = random_places(random, kScans);
    const Pose2 steady{60.0, 60.0, 0.0}; // not all chunks change
    places[0] = steady;
    for (const std::size_t stray : {kStray, kStray + 2}) places[stray] = Pose2{-50.0, 40.0, 0.0};
    auto better = moved(random, places);
    better[0] = steady;
    for (const std::size_t stray : {kStray, kStray + 2}) better[stray] = std::nullopt;

    Projection shown(config);
    apply(shown, {log.begin(), log.end() - 1}, places);
    const auto before = shown.snapshot();
    const auto digests_before = digests_of(before);
    apply(shown, {log.end() - 1, log.end()}, places);
    Projection corrected(config);
    apply(corrected, log, better);
    Projection wanted(config);
    apply(wanted, log, better);
    const auto expected = wanted.snapshot();

    shown.replace_with(std::move(corrected));
    const auto after = shown.snapshot();
    EXPECT_EQ(digests_of(after), digests_of(expected));
    EXPECT_NE(digests_of(after), digests_before);
    EXPECT_EQ(digests_of(before), digests_before) << "snapshots do not change";
    EXPECT_EQ(after.revision, log.size());
    EXPECT_EQ(bounds_of(after), bounds_of(expected));
    EXPECT_EQ(after.scan_poses.corrected(), log.size());
    const auto& robot = after.robots.at(0);
    EXPECT_EQ(robot.unplaced, expected.robots.at(0).unplaced);
    EXPECT_EQ(robot.scan_count, expected.robots.at(0).scan_count);
    EXPECT_EQ(robot.pose, expected.robots.at(0).pose);
    EXPECT_EQ(robot.last_seq, kScans);
    EXPECT_EQ(robot.trajectory.size(), expected.robots.at(0).trajectory.size());
    for (std::uint64_t seq = 1; seq <= kScans; ++seq) EXPECT_EQ(after.scan_poses.find(0, seq), better[seq - 1]);

    Blanked blanked;
    blanked.chunks += expect_changes_at(
        log.size(), before.laser, after.laser, expected.laser, [](const LaserChunk& a, const LaserChunk& b) {
            return a.occupancy == b.occupancy && a.himm == b.himm && a.occ_types.free == b.occ_types.free &&
                   a.occ_types.occupied == b.occ_types.occupied;
        });
    blanked.chunks += expect_changes_at(log.size(), before.sonar, after.sonar, expected.sonar,
                                        [](const SonarChunk& a, const SonarChunk& b) { return a.cells == b.cells; });
    const auto index = static_cast<std::int32_t>(steady.x / config.cell_size);
    EXPECT_LT(after.laser.find(grid::chunk_of({index, index}))->revision, log.size());
    after.classes.visit({}, 0, [&](grid::ChunkKey key, const auto& chunk) {
        if (expected.classes.find(key) != nullptr) return;
        ++blanked.classes;
        EXPECT_EQ(chunk.revision, log.size());
    });

    // The same entries give the same maps again.
    for (std::uint64_t seq = kScans + 1; seq <= kScans + 8; ++seq) {
        const LogEntry next = ScanTaken{0, random_scan(seed, seq)};
        EXPECT_TRUE(shown.apply(next));
        EXPECT_TRUE(wanted.apply(next));
    }
    EXPECT_EQ(digests_of(shown.snapshot()), digests_of(wanted.snapshot()));
    return blanked;
}

TEST(Projection, ReplacedMapsEqualThoseOfTheOtherPoses) {
    const std::vector<SessionOptions> kSettings = {
        {},
        {.ray_model = RayModel::kBresenham, .accumulate = true, .hit_radius = 0.2},
        {.ray_model = RayModel::kTraversal, .class_source = ClassSource::kHimm, .danger_radius = 0.4},
        {.cell_size = 0.2, .max_jump = 6.0},
    };
    Blanked all;
    for (std::size_t settings = 0; settings < kSettings.size(); ++settings) {
        for (unsigned seed = 1; seed <= 5; ++seed) {
            SCOPED_TRACE(testing::Message() << "settings " << settings << ", seed " << seed);
            const auto blanked = replace_random_maps(resolve(kSettings[settings]).value(), seed);
            all.chunks += blanked.chunks;
            all.classes += blanked.classes;
        }
    }
    EXPECT_GT(all.chunks, 0U);
    EXPECT_GT(all.classes, 0U);
}

TEST(Projection, MapsCorrectedAloneChangesNoMap) {
    Projection projection{MapConfig{}};
    auto log = log_without_poses(3, 4);
    std::mt19937 random(3);
    const auto places = random_places(random, 4);
    apply(projection, {log.begin(), log.end() - 1}, places);
    const auto before = projection.snapshot();
    ASSERT_TRUE(projection.apply(log.back()));
    const auto after = projection.snapshot();
    EXPECT_EQ(after.revision, before.revision + 1);
    EXPECT_EQ(digests_of(after), digests_of(before));
    EXPECT_EQ(after.laser.newest({}), before.laser.newest({}));
    EXPECT_EQ(after.scan_poses.corrected(), 0U);
}

} // namespace
} // namespace scanloom::mapping
