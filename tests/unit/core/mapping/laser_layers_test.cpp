#include "tests/support/angles.hpp"
#include "tests/support/laser_oracle.hpp"

#include "core/mapping/projection.hpp"
#include "tests/support/random_angles.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <gtest/gtest.h>

#include <array>
#include <iostream>
#include <map>
#include <random>
#include <string>
#include <vector>

/// Compares occupancy and HIMM layers after sequences of scans with a brute-force loop over cells and beams.
namespace scanloom::mapping {
namespace {

/// Several scans of one sensor from almost the same pose.
struct Run {
    std::string shape;
    Sensor sensor;
    std::vector<Scan> scans;
};

class RandomRuns {
public:
    explicit RandomRuns(unsigned seed) : random_(seed) {}

    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

    Run next(unsigned shape, double cell_size, std::size_t scans) {
        Run run;
        run.sensor.angles = testing_support::random_angles(random_, shape, run.shape);
        run.sensor.range_max = cell_size * uniform(3.0, 24.0);
        run.sensor.range_min = below(2) == 0 ? 0.0 : run.sensor.range_max * uniform(0.0, 0.3);
        if (below(3) == 0) run.sensor.aperture = uniform(0.001, 0.5);
        Pose2 pose{uniform(-4.0, 4.0), uniform(-4.0, 4.0), uniform(-kPi, kPi)};
        const bool on_the_grid = below(4) == 0; // on centres and borders of cells, with axis-aligned headings
        if (on_the_grid) {
            pose = {(below(41) - 20.0) * cell_size / 2, (below(41) - 20.0) * cell_size / 2, below(8) * kPi / 4};
        } else if (below(2) == 0) {
            run.sensor.mount = {uniform(-0.3, 0.3), uniform(-0.3, 0.3), uniform(-kPi, kPi)};
        }
        for (std::size_t n = 0; n < scans; ++n) {
            Scan scan{.seq = n + 1, .pose = pose};
            if (!on_the_grid && below(2) == 0) {
                scan.pose->x += uniform(-2.0, 2.0) * cell_size;
                scan.pose->yaw += uniform(-0.3, 0.3);
            }
            scan.ranges = n > 0 && below(2) == 0 ? run.scans.back().ranges : ranges_of(run.sensor);
            run.scans.push_back(std::move(scan));
        }
        return run;
    }

private:
    std::vector<RangeMm> ranges_of(const Sensor& sensor) {
        std::vector<RangeMm> ranges(beam_count(sensor.angles));
        const double common = uniform(0.2, 1.1) * sensor.range_max; // range of a wall on all sides
        const bool is_wall = below(2) == 0;
        for (auto& range : ranges) {
            const unsigned kind = below(12);
            const double z = is_wall ? common * uniform(0.97, 1.03) : uniform(0.0, 1.15) * sensor.range_max;
            range = kind == 0 ? kInvalidRange : kind == 1 ? kNoReturn : to_range_mm(z);
        }
        return ranges;
    }

    std::mt19937 random_;
};

const std::map<std::string, SessionOptions> kModels = {
    {"InverseSensorModel", {}},
    {"InverseSensorModelOfOtherValues",
     {.p_occupied = 0.7,
      .p_free = 0.35,
      .p_prior = 0.4,
      .p_min = 0.1,
      .p_max = 0.97,
      .obstacle_thickness = 0.3,
      .beam_aperture = 0.1,
      .himm_increment = 4,
      .himm_decrement = 2,
      .himm_obstacle_thickness = 0.05,
      .himm_beam_aperture = 0.3}},
    {"Bresenham", {.ray_model = RayModel::kBresenham, .p_prior = 0.6}},
    {"BresenhamWithHitRadius", {.ray_model = RayModel::kBresenham, .hit_radius = 0.2, .drop_no_return = true}},
    {"BresenhamAccumulating", {.ray_model = RayModel::kBresenham, .accumulate = true, .p_prior = 0.3}},
    {"BresenhamWithHitRadiusAccumulating",
     {.ray_model = RayModel::kBresenham, .accumulate = true, .hit_radius = 0.13, .p_occupied = 0.6, .p_free = 0.45}},
    {"Traversal", {.ray_model = RayModel::kTraversal, .p_prior = 0.25}},
    {"TraversalAccumulating",
     {.ray_model = RayModel::kTraversal, .accumulate = true, .p_occupied = 0.8, .p_free = 0.4, .p_max = 0.95}},
};

class LaserLayersBy : public testing::TestWithParam<std::pair<const std::string, SessionOptions>> {};

INSTANTIATE_TEST_SUITE_P(All, LaserLayersBy, testing::ValuesIn(kModels),
                         [](const auto& tried) { return tried.param.first; });

/// Integrates a run and compares the map with the oracle after every scan.
void expect_map_as_defined(const MapConfig& config, const Run& run, std::size_t& firm) {
    Projection projection(config);
    oracle::LaserOracle oracle(config);
    ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
    ASSERT_TRUE(projection.apply(SensorDescribed{0, run.sensor}));
    for (const Scan& scan : run.scans) {
        ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
        oracle.add(run.sensor, scan);
    }
    oracle.expect_equal(projection.snapshot(), run.shape, firm);
}

TEST_P(LaserLayersBy, MatchBruteForceForEveryShape) {
    std::size_t firm = 0;
    for (const double cell_size : {0.01, 0.05, 0.1, 0.5}) {
        SessionOptions options = GetParam().second;
        options.cell_size = cell_size;
        const MapConfig config = resolve(options).value();
        for (unsigned shape = 0; shape < testing_support::kAngleShapes; ++shape) {
            RandomRuns runs(1000 * shape + static_cast<unsigned>(100 * cell_size));
            for (const std::size_t scans : {1U, 5U}) {
                ASSERT_NO_FATAL_FAILURE(expect_map_as_defined(config, runs.next(shape, cell_size, scans), firm))
                    << "cell size " << cell_size << ", " << scans << " scans";
            }
        }
    }
    RecordProperty("firm_cells", static_cast<int>(firm));
    std::cout << firm << " firm cells\n";
    EXPECT_GT(firm, 20'000U) << "too few cells have a firm verdict to compare";
}

/// Returns the map after readings of one beam along +x from the centre of cell (0, 0), with a cell size of 0.1 m.
Snapshot after_one_beam(SessionOptions options, const std::vector<RangeMm>& readings, double range_max = 5.0) {
    options.cell_size = 0.1;
    Projection projection(resolve(options).value());
    Sensor beam;
    beam.angles = UniformAngles{0.0, 1.0, 1};
    beam.range_max = range_max;
    EXPECT_TRUE(projection.apply(RobotJoined{0, "r"}));
    EXPECT_TRUE(projection.apply(SensorDescribed{0, beam}));
    std::uint64_t seq = 0;
    for (const RangeMm reading : readings) {
        EXPECT_TRUE(
            projection.apply(ScanTaken{0, {.seq = ++seq, .pose = Pose2{0.05, 0.05, 0.0}, .ranges = {reading}}}));
    }
    return projection.snapshot();
}

TEST(Himm, CountsUpByThreeAndDownByOneFromZeroToFifteen) {
    std::vector<RangeMm> readings;
    const auto count_after = [&](RangeMm reading) {
        readings.push_back(reading);
        return int{testing_support::himm_at(after_one_beam({}, readings), {10, 0})};
    };
    for (const int expected : {3, 6, 9, 12, 15, 15}) EXPECT_EQ(count_after(1000), expected);
    for (int expected = 14; expected >= 0; --expected) EXPECT_EQ(count_after(3000), expected);
    EXPECT_EQ(count_after(3000), 0);
    EXPECT_EQ(count_after(1000), 3);
}

TEST(Himm, CountOfZeroIsNotUnseen) {
    const auto snapshot = after_one_beam({}, {3000});
    EXPECT_EQ(testing_support::himm_at(snapshot, {10, 0}), 0);
    EXPECT_EQ(testing_support::himm_at(snapshot, {10, 5}), 255);
}

TEST(Himm, BandIsTwiceAsWideAsThatOfOccupancy) {
    const auto snapshot = after_one_beam({}, {1030});
    for (const int i : {10, 11}) EXPECT_EQ(testing_support::himm_at(snapshot, {i, 0}), 3) << "|r - z| < 0.1 m";
    EXPECT_EQ(testing_support::himm_at(snapshot, {12, 0}), 255);
    EXPECT_EQ(testing_support::himm_at(snapshot, {9, 0}), 0);
    EXPECT_EQ(testing_support::occupancy_at(snapshot, {11, 0}), kUnknownLogOdds) << "|r - z| is 0.07 m";
}

TEST(RayModels, BeamWithoutReturnFreesItsEndCellAndMarksNone) {
    for (const auto model : {RayModel::kBresenham, RayModel::kTraversal}) {
        for (const RangeMm reading : {kNoReturn, RangeMm{2000}, RangeMm{9000}}) {
            const auto snapshot = after_one_beam({.ray_model = model}, {reading}, 2.0);
            for (int i = 0; i <= 20; ++i) EXPECT_LT(testing_support::occupancy_at(snapshot, {i, 0}), 0) << i;
            EXPECT_EQ(testing_support::occupancy_at(snapshot, {21, 0}), kUnknownLogOdds);
            EXPECT_EQ(testing_support::occupancy_at(
                          after_one_beam({.ray_model = model, .drop_no_return = true}, {reading}, 2.0), {5, 0}),
                      kUnknownLogOdds);
        }
    }
}

TEST(BeamIndex, MatchesALoopOverAllBeams) {
    std::mt19937 random(3);
    for (unsigned shape = 0; shape < testing_support::kAngleShapes; ++shape) {
        for (int round = 0; round < 5; ++round) {
            std::string name;
            const BeamAngles angles = testing_support::random_angles(random, shape, name);
            oracle::Scene scene{.explicit_angles = !std::holds_alternative<UniformAngles>(angles)};
            for (std::size_t b = 0; b < beam_count(angles); ++b) scene.beam_angles.push_back(beam_angle(angles, b));
            scene.sight = oracle::sight_of(scene);
            const oracle::BeamIndex index(scene);
            for (int n = 0; n < 300; ++n) {
                double phi = std::uniform_real_distribution<double>(-7.0, 7.0)(random);
                if (n % 4 == 0) phi = scene.beam_angles[random() % scene.beam_angles.size()];
                const auto expected = oracle::sighting_at(scene, phi);
                EXPECT_EQ(index(phi).beam, expected.beam) << name << ", " << phi;
                EXPECT_EQ(index(phi).is_seen, expected.is_seen) << name << ", " << phi;
            }
        }
    }
}

} // namespace
} // namespace scanloom::mapping
