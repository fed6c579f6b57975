#include "core/mapping/projection.hpp"

#include "core/mapping/reach.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/restored.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>

namespace scanloom::mapping {
namespace {

using testing_support::digests_of;

Sensor laser() {
    Sensor sensor;
    sensor.id = 2;
    sensor.angles = UniformAngles{-std::numbers::pi, 2 * std::numbers::pi / 90, 90};
    sensor.range_max = 4.0;
    return sensor;
}

Sensor sonar_ring() {
    Sensor sensor;
    sensor.id = 3;
    sensor.kind = SensorKind::kSonar;
    sensor.angles = UniformAngles{-std::numbers::pi, 2 * std::numbers::pi / 8, 8};
    sensor.aperture = 0.5;
    sensor.range_max = 3.0;
    return sensor;
}

/// Returns a log in which every fourth scan is of a ring of sonars and the others are of a laser.
std::vector<LogEntry> random_log(unsigned seed, std::size_t scans) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> metres(-8.0, 8.0);
    std::vector<LogEntry> log{RobotJoined{0, "r0"}, SensorDescribed{0, laser()}, SensorDescribed{0, sonar_ring()}};
    for (std::uint64_t seq = 1; seq <= scans; ++seq) {
        const bool by_sonar = seq % 4 == 0;
        Scan scan;
        scan.seq = seq;
        scan.stamp = static_cast<double>(seq) * 0.1;
        scan.sensor = by_sonar ? 3 : 2;
        scan.pose = {metres(random), metres(random), metres(random)};
        for (int beam = 0; beam < (by_sonar ? 8 : 90); ++beam) {
            scan.ranges.push_back(static_cast<RangeMm>(random() % 4500));
        }
        log.push_back(ScanTaken{0, std::move(scan)});
    }
    return log;
}

constexpr std::size_t kBeforeScans = 3; // entries of random_log()

/// The cells of the occupancy layer at the time of a snapshot.
class Occupancy {
public:
    explicit Occupancy(const Snapshot& snapshot) : view_(snapshot.laser) {}
    [[nodiscard]] LogOdds at(grid::Cell cell) const {
        const auto* chunk = view_.find(grid::chunk_of(cell));
        return chunk == nullptr ? kUnknownLogOdds : chunk->occupancy[grid::index_in_chunk(cell)];
    }

private:
    LaserView view_;
};

/// Settings that cover every code path of integration.
class ProjectionWith : public testing::TestWithParam<std::pair<const std::string, SessionOptions>> {
protected:
    [[nodiscard]] static MapConfig config() { return resolve(GetParam().second).value(); }
};

const std::map<std::string, SessionOptions> kMappingSettings = {
    {"Sectors", {}},
    {"Bresenham", {.ray_model = RayModel::kBresenham, .hit_radius = 0.2}},
    {"TraversalAndHimmClasses", {.ray_model = RayModel::kTraversal, .class_source = ClassSource::kHimm}},
    {"Accumulation", {.ray_model = RayModel::kBresenham, .accumulate = true}},
    {"OtherApertures", {.drop_no_return = true, .himm_beam_aperture = 0.2, .danger_radius = 0.4}},
};

INSTANTIATE_TEST_SUITE_P(Projection, ProjectionWith, testing::ValuesIn(kMappingSettings),
                         [](const auto& tried) { return tried.param.first; });

TEST(Projection, UpdatesEachCellByTheUpdateRule) {
    Projection projection(*resolve({.cell_size = 0.1, .p_prior = 0.4}));
    Sensor beam;
    beam.angles = UniformAngles{0.0, 1.0, 1};
    beam.range_max = 5.0;
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, beam}));
    const double l0 = log_odds_of(0.4);
    const double free_cell_steps[] = {l0 + (log_odds_of(0.1) - l0), l0 + 2 * (log_odds_of(0.1) - l0)};
    for (std::uint64_t seq = 1; seq <= 10; ++seq) {
        Scan scan{.seq = seq, .pose = Pose2{0.05, 0.05, 0.0}, .ranges = {1000}};
        ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
        const auto snapshot = projection.snapshot();
        const Occupancy occupancy(snapshot);
        const double expected =
            seq <= 2 ? free_cell_steps[seq - 1]
                     : std::max(log_odds_of(0.001), l0 + static_cast<double>(seq) * (log_odds_of(0.1) - l0));
        EXPECT_NEAR(occupancy.at({5, 0}) / kLogOddsScale, expected, 0.006);
        EXPECT_EQ(occupancy.at({5, 1}), kUnknownLogOdds);
    }
    const auto snapshot = projection.snapshot();
    EXPECT_NEAR(probability_of(Occupancy(snapshot).at({5, 0})), 0.001, 1e-6) << "at the lower clamp";
    EXPECT_NEAR(probability_of(Occupancy(snapshot).at({10, 0})), 0.999, 1e-6) << "at the upper clamp";
}

TEST(Projection, CellBackAtEvenOddsStaysKnown) {
    Projection projection(*resolve({.cell_size = 0.1}));
    Sensor beam;
    beam.angles = UniformAngles{0.0, 1.0, 1};
    beam.range_max = 5.0;
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, beam}));
    ASSERT_TRUE(projection.apply(ScanTaken{0, {.seq = 1, .pose = Pose2{0.05, 0.05, 0.0}, .ranges = {1000}}}));
    ASSERT_TRUE(projection.apply(ScanTaken{0, {.seq = 2, .pose = Pose2{0.05, 0.05, 0.0}, .ranges = {2000}}}));
    EXPECT_EQ(Occupancy(projection.snapshot()).at({10, 0}), 0);
}

TEST(Projection, EvidenceBetweenTheClampLimitsKeepsItsSign) {
    Projection projection(*resolve(
        {.cell_size = 0.1, .p_occupied = 0.9999, .p_free = 1e-6, .p_prior = 0.999, .p_min = 1e-6, .p_max = 0.9999}));
    Sensor beam;
    beam.angles = UniformAngles{0.0, 1.0, 1};
    beam.range_max = 5.0;
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, beam}));
    ASSERT_TRUE(projection.apply(ScanTaken{0, {.seq = 1, .pose = Pose2{0.05, 0.05, 0.0}, .ranges = {1000}}}));
    EXPECT_LT(probability_of(Occupancy(projection.snapshot()).at({5, 0})), 0.01);
}

TEST_P(ProjectionWith, SnapshotsBetweenScansDoNotChangeTheMap) {
    const auto log = random_log(1, 60);
    Projection plain{config()};
    Projection watched{config()};
    std::vector<Snapshot> kept;
    for (const auto& entry : log) {
        ASSERT_TRUE(plain.apply(entry));
        ASSERT_TRUE(watched.apply(entry));
        kept.push_back(watched.snapshot());
    }
    EXPECT_EQ(digests_of(plain.snapshot()), digests_of(watched.snapshot()));
    Projection again{config()};
    for (std::size_t n = 0; n < log.size(); ++n) {
        ASSERT_TRUE(again.apply(log[n]));
        if (n % 13 == 0) {
            EXPECT_EQ(digests_of(kept[n]), digests_of(again.snapshot())) << "after entry " << n;
            EXPECT_EQ(kept[n].robots.front().trajectory.size(), n < kBeforeScans ? 0 : n + 1 - kBeforeScans);
        }
    }
}

TEST_P(ProjectionWith, ScansIntegratedInSlicesGiveTheSameMap) {
    auto log = random_log(3, 40);
    for (auto& entry : log) { // explicit angles in any order: the projection makes a beam fan for that scan only
        auto* taken = std::get_if<ScanTaken>(&entry);
        if (taken == nullptr || taken->scan.seq % 3 != 0) continue;
        ExplicitAngles angles(taken->scan.ranges.size());
        for (std::size_t n = 0; n < angles.size(); ++n) angles[n] = 0.7 * static_cast<double>(n * 5 % angles.size());
        taken->scan.angles = angles;
    }
    Projection whole{config()};
    Projection sliced{config()};
    std::size_t slices = 0;
    for (const auto& entry : log) {
        ASSERT_TRUE(whole.apply(entry));
        for (bool in = false; !in; ++slices) {
            double work = 1000.0;
            in = sliced.apply(entry, work).value();
            EXPECT_EQ(sliced.revision(), in ? whole.revision() : whole.revision() - 1);
        }
    }
    EXPECT_GT(slices, log.size() + 40) << "no scan was integrated in slices";
    const auto a = whole.snapshot();
    const auto b = sliced.snapshot();
    EXPECT_EQ(a.bounds, b.bounds);
    EXPECT_EQ(digests_of(a), digests_of(b));
    EXPECT_EQ(a.robots.front().trajectory.size(), b.robots.front().trajectory.size());
}

TEST_P(ProjectionWith, ContinuingFromACheckpointGivesTheSameMap) {
    const auto log = random_log(2, 300);
    Projection whole{config()};
    for (const auto& entry : log) ASSERT_TRUE(whole.apply(entry));

    Projection first{config()};
    for (std::size_t n = 0; n < 201; ++n) ASSERT_TRUE(first.apply(log[n]));
    Projection second = testing_support::restored(first);
    for (std::size_t n = 201; n < log.size(); ++n) ASSERT_TRUE(second.apply(log[n]));

    const auto a = whole.snapshot();
    const auto b = second.snapshot();
    EXPECT_EQ(a.revision, b.revision);
    EXPECT_EQ(a.bounds, b.bounds);
    EXPECT_EQ(digests_of(a), digests_of(b));
    EXPECT_EQ(a.robots.front().scan_count, b.robots.front().scan_count);
    EXPECT_EQ(a.robots.front().pose, b.robots.front().pose);
    ASSERT_EQ(a.robots.front().trajectory.size(), b.robots.front().trajectory.size());
    EXPECT_EQ(a.robots.front().trajectory[299], b.robots.front().trajectory[299]);
    EXPECT_EQ(b.robots.front().trajectory.begin(), 200U - kBeforeScans) << "older points are only in the log";
    EXPECT_EQ(a.robots.front().trajectory.first_after(150 + kBeforeScans), 150U);
    EXPECT_EQ(b.robots.front().trajectory.first_after(b.revision), 300U);
}

TEST(Projection, RejoiningMayChangeTheBodyButNotTheSource) {
    Projection projection{MapConfig{}};
    const auto radius = [&] { return projection.snapshot().robots.at(0).body_radius; };
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r", "a", 0.2}));
    EXPECT_EQ(radius(), 0.2);
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r", "b", 0.2}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, laser()}));
    ASSERT_TRUE(projection.apply(ScanTaken{0, {.seq = 1, .sensor = 2, .pose = Pose2{}, .ranges = {1}}}));
    const auto cells = testing_support::digests_of(projection.snapshot());
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r", "b", 0.4}));
    EXPECT_EQ(radius(), 0.4);
    EXPECT_FALSE(projection.apply(RobotJoined{0, "r", "a", 0.4}));
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r", "b"}));
    EXPECT_EQ(radius(), std::nullopt) << "the newest description applies, even without a radius";
    EXPECT_EQ(projection.snapshot().robots.at(0).scan_count, 1U);
    EXPECT_EQ(testing_support::digests_of(projection.snapshot()), cells);
}

TEST(Projection, RefusesEntriesOutOfSequence) {
    Projection projection{MapConfig{}};
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, testing_support::small_laser()}));
    EXPECT_EQ(projection.apply(ScanTaken{0, testing_support::random_scan(1, 2)}).error().code, Errc::kMalformed);
    EXPECT_EQ(projection.revision(), 2U);
    EXPECT_EQ(projection.chunk_count(), 0U);
    EXPECT_TRUE(projection.apply(ScanTaken{0, testing_support::random_scan(1, 1)}));
}

TEST(Projection, AcceptsScansOfDifferentBeamCounts) {
    Projection projection{MapConfig{}};
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, laser()}));
    std::uint64_t seq = 0;
    for (const std::size_t beams : {90U, 1U, 45U, 90U, 7U}) {
        Scan scan{.seq = ++seq, .sensor = 2, .pose = Pose2{}, .ranges = std::vector<RangeMm>(beams, 2000)};
        EXPECT_TRUE(projection.apply(ScanTaken{0, scan}));
        scan.seq = ++seq;
        ExplicitAngles angles(beams);
        for (std::size_t b = 0; b < beams; ++b) angles[b] = 0.01 * static_cast<double>(b * b % 300);
        scan.angles = angles;
        EXPECT_TRUE(projection.apply(ScanTaken{0, scan}));
    }
    EXPECT_EQ(projection.snapshot().robots.front().scan_count, 10U);
}

TEST(Projection, UsesTheNewestDescriptionOfASensor) {
    Sensor turned = laser();
    std::get<UniformAngles>(turned.angles).first += 1.0;
    const std::size_t beams = beam_count(turned.angles);
    const auto digests = [&](const std::vector<Sensor>& descriptions) {
        Projection projection{MapConfig{}};
        EXPECT_TRUE(projection.apply(RobotJoined{0, "r"}));
        std::uint64_t seq = 0;
        for (const Sensor& described : descriptions) {
            EXPECT_TRUE(projection.apply(SensorDescribed{0, described}));
            // The scan has no valid reading, so it changes no cell, but the projection caches the beams' directions.
            Scan scan{.seq = ++seq, .sensor = 2, .pose = Pose2{}, .ranges = std::vector<RangeMm>(beams, kInvalidRange)};
            EXPECT_TRUE(projection.apply(ScanTaken{0, scan}));
        }
        Scan scan{.seq = ++seq, .sensor = 2, .pose = Pose2{}, .ranges = std::vector<RangeMm>(beams, kInvalidRange)};
        std::fill_n(scan.ranges.begin(), beams / 4, 2000);
        EXPECT_TRUE(projection.apply(ScanTaken{0, scan}));
        return testing_support::digests_of(projection.snapshot());
    };
    EXPECT_EQ(digests({laser(), turned}), digests({turned}));
    EXPECT_NE(digests({laser()}), digests({turned})) << "the two descriptions must give different maps";
}

TEST(Projection, RefusesTooLongRangeByFieldName) {
    Sensor sensor = laser();
    sensor.range_max = 81.0;
    EXPECT_TRUE(check_reach(*resolve({.cell_size = 0.01}), sensor));
    sensor.range_max = 82.0;
    const auto refused = check_reach(*resolve({.cell_size = 0.01}), sensor);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, testing::StartsWith("range_max is 82"));
}

} // namespace
} // namespace scanloom::mapping
