#include "core/mapping/reach.hpp"

#include "core/mapping/projection.hpp"
#include "core/mapping/snapshot.hpp"
#include "tests/support/random_scans.hpp"

#include <gtest/gtest.h>

/// Compares the predicted reach of a scan with the cells that its integration changes.
namespace scanloom::mapping {
namespace {

Sensor sensor_of(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Sensor sensor = testing_support::small_laser();
    const auto beams = static_cast<std::uint32_t>(1 + random() % 90);
    sensor.range_min = unit(random);
    sensor.range_max = 1.0 + 20.0 * unit(random);
    sensor.mount = {unit(random), -unit(random), 3.0 * unit(random)};
    if (random() % 2 != 0) sensor.aperture = 0.2 * unit(random) + 0.001;
    sensor.angles = UniformAngles{6.0 * unit(random), 0.001 + unit(random) * 6.2 / beams, beams};
    if (random() % 3 == 0) {
        ExplicitAngles angles(beams);
        for (auto& angle : angles) angle = 6.0 * unit(random) - 3.0;
        sensor.angles = angles;
    } else if (random() % 3 == 0) {
        SteppedAngles angles{0.003, {}};
        for (std::uint32_t beam = 0; beam < beams; ++beam) {
            angles.steps.push_back(static_cast<std::int32_t>(random() % 2000) - 1000);
        }
        sensor.angles = angles;
    }
    return sensor;
}

Scan scan_of(const Sensor& sensor, std::mt19937& random) {
    Scan scan = testing_support::random_scan(static_cast<unsigned>(random()), 1);
    scan.ranges.assign(beam_count(sensor.angles), 0);
    for (auto& range : scan.ranges) {
        const auto kind = random() % 10;
        range = kind == 0 ? kInvalidRange : kind == 1 ? kNoReturn : static_cast<RangeMm>(random() % 22'000);
    }
    return scan;
}

std::int64_t known_cells(const Snapshot& snapshot) {
    std::int64_t seen = 0;
    for (const Layer layer : {Layer::kOccupancy, Layer::kHimm, Layer::kSonar}) {
        with_layer(snapshot, layer, [&](const auto& view, auto&& cells_of) {
            view.visit({}, 0, [&](grid::ChunkKey, const auto& chunk) {
                seen += std::ranges::count_if(cells_of(chunk), [](auto cell) { return is_known(cell); });
            });
        });
    }
    return seen;
}

TEST(Reach, CoversAllCellsThatIntegrationChanges) {
    std::mt19937 random(7);
    for (int round = 0; round < 600; ++round) {
        MapConfig config;
        config.cell_size = 0.02 + 0.001 * static_cast<double>(random() % 300);
        config.ray_model = static_cast<RayModel>(random() % 3);
        if (config.ray_model == RayModel::kBresenham) config.hit_radius = 0.1 * static_cast<double>(random() % 4);
        config.accumulate = config.ray_model != RayModel::kInverseSensorModel && random() % 2 == 0;
        Sensor sensor = sensor_of(random);
        if (random() % 3 == 0) sensor.kind = SensorKind::kSonar;
        const Scan scan = scan_of(sensor, random);
        Projection projection(config);
        ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
        ASSERT_TRUE(projection.apply(SensorDescribed{0, sensor}));
        ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));

        const Reach reach = reach_of(config, sensor, scan);
        const auto snapshot = projection.snapshot();
        grid::CellBox both = reach.cells;
        both.include(bounds_of(snapshot));
        EXPECT_EQ(both, reach.cells) << "round " << round;
        EXPECT_GE(chunk_count_of(reach.cells), static_cast<std::int64_t>(projection.chunk_count()));
        EXPECT_GE(reach.work, 0.95 * static_cast<double>(known_cells(snapshot))) << "round " << round;
    }
}

/// The limits of a sensor may lie between two millimetres: 4.9 m as a float is 4.900000095 m.
TEST(Reach, CoversReadingsAtTheSensorsLimits) {
    std::mt19937 random(8);
    for (int round = 0; round < 400; ++round) {
        Sensor sensor = testing_support::small_laser();
        const auto limit = [&] {
            return 0.5 + 0.001 * static_cast<double>(random() % 5000) + 1e-4 * static_cast<double>(random() % 11);
        };
        sensor.range_max = round % 4 == 0 ? static_cast<double>(static_cast<float>(limit())) : limit();
        sensor.range_min = round % 2 == 0 ? 0.0 : sensor.range_max * 0.5;
        MapConfig config;
        config.drop_no_return = round % 3 != 0;
        const double of = random() % 2 == 0 ? sensor.range_max : sensor.range_min;
        Scan scan = testing_support::random_scan(1, 1);
        scan.ranges.assign(18, static_cast<RangeMm>(std::lround(of * 1000.0) + static_cast<int>(random() % 3) - 1));

        Projection projection(config);
        ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
        ASSERT_TRUE(projection.apply(SensorDescribed{0, sensor}));
        ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
        const Reach reach = reach_of(config, sensor, scan);
        const auto seen = known_cells(projection.snapshot());
        EXPECT_EQ(reach.work > 0.0, seen > 0)
            << sensor.range_min << " .. " << sensor.range_max << ", " << scan.ranges[0];
        EXPECT_GE(reach.work, 0.95 * static_cast<double>(seen));
        EXPECT_GE(chunk_count_of(reach.cells), static_cast<std::int64_t>(projection.chunk_count()));
    }
}

TEST(Reach, IsEmptyForAScanWithoutReadings) {
    Scan scan = testing_support::random_scan(1, 1);
    scan.ranges.assign(18, kInvalidRange);
    const Reach reach = reach_of({}, testing_support::small_laser(), scan);
    EXPECT_EQ(chunk_count_of(reach.cells), 0);
    EXPECT_EQ(reach.work, 0.0);
}

TEST(Reach, DependsOnTheLongestReadingOnly) {
    Sensor sensor = testing_support::small_laser();
    sensor.range_max = 80.0;
    Scan scan = testing_support::random_scan(1, 1);
    scan.ranges.assign(18, 2000);
    const Reach reach = reach_of({}, sensor, scan);
    EXPECT_LE(reach.cells.width(), 2 * (40 + 2) + 4) << "2 m plus half the band of HIMM";
    EXPECT_LE(chunk_count_of(reach.cells), 9);
}

TEST(Reach, CountsChunksOnBothSidesOfTheOrigin) {
    EXPECT_EQ(chunk_count_of({}), 0);
    EXPECT_EQ(chunk_count_of({0, 0, 64, 64}), 1);
    EXPECT_EQ(chunk_count_of({-1, -1, 65, 1}), 6);
}

} // namespace
} // namespace scanloom::mapping
