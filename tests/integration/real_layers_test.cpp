#include "core/mapping/projection.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/class_oracle.hpp"
#include "tests/support/laser_oracle.hpp"
#include "tests/support/murphy_oracle.hpp"
#include "tests/support/snapshot_cells.hpp"
#include "tests/support/whole_log.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

/// Every layer of maps of real recordings, compared with brute force.
namespace scanloom {
namespace {

using mapping::MapConfig;
using mapping::Projection;
using mapping::Snapshot;

std::filesystem::path shared_data() { return std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data"; }

/// Consecutive scans from several parts of a log.
std::vector<robot::Observation> sampled(const char* file) {
    constexpr double kRangeMax = 9.0; // metres: longer ranges are free space, which covers no-return beams, too
    const auto log = robot::read_whole_log(shared_data() / "logs" / file,
                                           {.no_return = robot::NoReturn::kFree, .range_max = kRangeMax, .limits = {}},
                                           [](const robot::SkippedLine& line) { ADD_FAILURE() << line.reason; });
    EXPECT_TRUE(log) << log.error().message;
    if (!log) return {};
    constexpr std::size_t kPlaces = 10;
    constexpr std::size_t kInARow = 3;
    std::vector<robot::Observation> some;
    const std::size_t step = log->observations.size() / kPlaces;
    for (std::size_t n = 0; n < log->observations.size() && some.size() < kPlaces * kInARow; n += step) {
        for (std::size_t k = 0; k < kInARow; ++k) some.push_back(log->observations[n + k]);
    }
    return some;
}

using LayerCase = std::tuple<const char*, double, RayModel>; // file, cell size

class RealLayers : public testing::TestWithParam<LayerCase> {
protected:
    void SetUp() override {
        const auto path = shared_data() / "logs" / std::get<0>(GetParam());
        if (!std::filesystem::exists(path)) GTEST_SKIP() << "missing file: " << path;
    }

    [[nodiscard]] static MapConfig config() {
        const auto [file, cell_size, model] = GetParam();
        const bool is_sectors = model == RayModel::kInverseSensorModel;
        return mapping::resolve(
                   {.cell_size = cell_size,
                    .ray_model = model,
                    .accumulate = model == RayModel::kTraversal && cell_size > 0.07,
                    .hit_radius = model == RayModel::kBresenham ? 0.2 : 0.0,
                    .p_prior = is_sectors ? 0.5 : 0.4,
                    .class_source = model == RayModel::kBresenham ? ClassSource::kHimm : ClassSource::kOccupancy})
            .value();
    }
};

std::string name_of(const LayerCase& layers) {
    const auto [file, cell_size, model] = layers;
    return std::string(file).substr(0, std::string(file).find('-')) +
           (cell_size == 0.05 ? "_at_5cm_by_" : "_at_10cm_by_") +
           (model == RayModel::kInverseSensorModel ? "Sectors"
            : model == RayModel::kBresenham        ? "Bresenham"
                                                   : "Traversal");
}

INSTANTIATE_TEST_SUITE_P(
    All, RealLayers,
    testing::Combine(testing::Values("intel-corrected.log.gz", "fr079-corrected.log.gz"), testing::Values(0.05, 0.1),
                     testing::Values(RayModel::kInverseSensorModel, RayModel::kBresenham, RayModel::kTraversal)),
    [](const auto& tried) { return name_of(tried.param); });

std::size_t expect_defined_classes(const oracle::OccTypes& types, const Snapshot& snapshot) {
    const std::int32_t reach = mapping::danger_reach(snapshot.config);
    std::size_t compared = 0;
    std::size_t wrong = 0;
    types.plane().for_each(2, [&](grid::Cell cell, classify::OccType) {
        ++compared;
        wrong += testing_support::class_at(snapshot, cell) != oracle::class_of(types.plane(), cell, reach);
    });
    EXPECT_EQ(wrong, 0U) << "classes, of " << compared;
    return compared;
}

TEST_P(RealLayers, LaserLayersEqualTheirDefinitions) {
    Projection projection(config());
    oracle::LaserOracle evidence(config());
    oracle::OccTypes types(config());
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    const Sensor* described = nullptr;
    std::uint64_t seq = 0;
    for (auto& [sensor, scan] : sampled(std::get<0>(GetParam()))) {
        if (described == nullptr || *described != *sensor) {
            ASSERT_TRUE(projection.apply(SensorDescribed{0, *sensor}));
        }
        described = sensor.get();
        scan.seq = ++seq;
        ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
        evidence.add(*sensor, scan);
        types.apply(projection.snapshot());
    }
    ASSERT_GE(seq, 25U);
    std::size_t firm = 0;
    const auto snapshot = projection.snapshot();
    ASSERT_NO_FATAL_FAILURE(evidence.expect_equal(snapshot, std::get<0>(GetParam()), firm));
    const auto classes = expect_defined_classes(types, snapshot);
    std::cout << firm << " firm cells of evidence, " << classes << " of classes\n";
    EXPECT_GT(firm, 20'000U);
}

/// The ring of eight sonars and its poses, as recorded.
struct RingLog {
    Sensor ring;
    std::vector<Scan> scans;
};

RingLog read_ring() {
    RingLog log;
    log.ring = {.id = 1, .kind = SensorKind::kSonar, .aperture = 30.0 * kDegree, .range_max = 5.11};
    ExplicitAngles angles;
    for (const double degrees : {-90.0, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90.0}) angles.push_back(degrees * kDegree);
    log.ring.angles = angles;

    std::ifstream measurements(shared_data() / "sonar/measurement.txt");
    std::ifstream poses(shared_data() / "sonar/poses.txt");
    std::string measurement;
    std::string pose;
    while (std::getline(measurements, measurement) && std::getline(poses, pose)) {
        std::istringstream readings(measurement);
        std::istringstream placed(pose);
        double time_ms = 0.0;
        double pose_time_ms = 0.0;
        double x = 0.0;
        double y = 0.0;
        double heading = 0.0;
        readings >> time_ms;
        placed >> pose_time_ms >> x >> y >> heading;
        EXPECT_EQ(time_ms, pose_time_ms) << measurement;
        Scan scan{.seq = log.scans.size() + 1, .stamp = time_ms / 1000.0, .sensor = 1};
        scan.pose = {x / 1000.0, y / 1000.0, normalize_angle(heading / 10.0 * kDegree)};
        for (RangeMm mm = 0; readings >> mm;) scan.ranges.push_back(mm == 5110 ? kNoReturn : mm);
        EXPECT_EQ(scan.ranges.size(), 8U) << measurement;
        log.scans.push_back(std::move(scan));
    }
    return log;
}

TEST(RealSonar, SonarLayerEqualsMultipliedProbabilities) {
    if (!std::filesystem::exists(shared_data() / "sonar"))
        GTEST_SKIP() << "missing directory: " << shared_data() / "sonar";
    const RingLog log = read_ring();
    ASSERT_EQ(log.scans.size(), 413U);
    const MapConfig config = mapping::resolve({.cell_size = 0.1}).value();
    Projection projection(config);
    oracle::MurphyOracle oracle(config);
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, log.ring}));
    for (const Scan& scan : log.scans) {
        ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
        oracle.add(log.ring, scan);
    }
    const auto snapshot = projection.snapshot();
    std::size_t firm = 0;
    ASSERT_NO_FATAL_FAILURE(oracle.expect_near(snapshot, "the ring", firm));
    std::cout << firm << " firm cells\n";
    EXPECT_GT(firm, 10'000U);

    std::size_t free = 0;
    std::size_t occupied = 0;
    snapshot.sonar.visit({}, 0, [&](grid::ChunkKey, const mapping::SonarChunk& chunk) {
        for (const auto cell : chunk.cells) {
            if (cell == mapping::kUnknownLogOdds) continue;
            free += mapping::probability_of(cell) < 0.35;
            occupied += mapping::probability_of(cell) > 0.65;
        }
    });
    EXPECT_GT(free, 5'000U);
    EXPECT_GT(occupied, 500U);
    EXPECT_EQ(snapshot.laser.find({0, 0}), nullptr) << "sonars do not change laser layers";
}

} // namespace
} // namespace scanloom
