#include "core/mapping/sonar_layer.hpp"

#include "core/mapping/projection.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/murphy_oracle.hpp"
#include "tests/support/random_angles.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <random>
#include <string>
#include <vector>

/// Compares Murphy's sonar model in log-odds with the product rule in probabilities.
namespace scanloom::mapping {
namespace {

TEST(SonarProbability, MatchesTheWorkedExample) {
    // R = 5 m, r = 2.5 m, a = 0, half aperture 15 degrees: w = 0.75.
    const double in_band = sonar_probability(Verdict::kOccupied, 2.5, 5.0, 0.0, 15 * kDegree);
    const double before_it = sonar_probability(Verdict::kFree, 2.5, 5.0, 0.0, 15 * kDegree);
    EXPECT_DOUBLE_EQ(in_band, 0.875);
    EXPECT_DOUBLE_EQ(before_it, 0.125);
    // The update of p = 0.5 gives 0.875, and the next update with 0.875 gives 0.98.
    const double once = oracle::product_rule(in_band, 0.5);
    EXPECT_DOUBLE_EQ(once, 0.875);
    EXPECT_DOUBLE_EQ(oracle::product_rule(in_band, once), 0.98);
}

/// A map with a cell size of 0.1 m, observed by sonars with a range of 5 m.
class SonarMap {
public:
    explicit SonarMap(BeamAngles angles, SessionOptions options = {})
        : projection_([&] {
              options.cell_size = 0.1;
              return resolve(options).value();
          }()) {
        Sensor ring{.id = 1, .kind = SensorKind::kSonar, .angles = std::move(angles), .range_max = 5.0};
        EXPECT_TRUE(projection_.apply(RobotJoined{0, "r"}));
        EXPECT_TRUE(projection_.apply(SensorDescribed{0, ring}));
    }

    void fire(const std::vector<RangeMm>& ranges) {
        const Scan scan{.seq = ++seq_, .sensor = 1, .pose = Pose2{0.05, 0.05, 0.0}, .ranges = ranges};
        EXPECT_TRUE(projection_.apply(ScanTaken{0, scan}));
    }

    [[nodiscard]] LogOdds at(grid::Cell cell) { return testing_support::sonar_at(projection_.snapshot(), cell); }
    [[nodiscard]] double p(grid::Cell cell) { return probability_of(at(cell)); }
    [[nodiscard]] Snapshot snapshot() { return projection_.snapshot(); }

private:
    Projection projection_;
    std::uint64_t seq_ = 0;
};

constexpr double kOneStep = 1.0 / 4096; // step in probability, larger than the rounding error of one log-odds update

TEST(SonarLayer, MatchesTheWorkedExample) {
    SonarMap map{UniformAngles{0.0, 1.0, 1}};
    map.fire({2500});
    EXPECT_NEAR(map.p({25, 0}), 0.875, kOneStep) << "2.5 m away on the axis: region I";
    map.fire({2500});
    EXPECT_NEAR(map.p({25, 0}), 0.98, kOneStep);
    SonarMap free{UniformAngles{0.0, 1.0, 1}};
    free.fire({4000});
    EXPECT_NEAR(free.p({25, 0}), 0.125, kOneStep) << "region II";
}

TEST(SonarLayer, OneEchoIsLimitedToTheMaximum) {
    SonarMap map{UniformAngles{0.0, 1.0, 1}, {.sonar_p_max = 0.999}};
    map.fire({100}); // w = 0.99 at 0.1 m: 0.995 without the limit
    EXPECT_NEAR(map.p({1, 0}), 0.98, kOneStep);
    for (int n = 0; n < 5; ++n) map.fire({100});
    EXPECT_NEAR(map.p({1, 0}), 0.999, kOneStep) << "at the clamp";
}

TEST(SonarLayer, IsClampedAfterEachEcho) {
    SonarMap map{UniformAngles{0.0, 1.0, 1}};
    for (int n = 0; n < 40; ++n) map.fire({4000});
    EXPECT_NEAR(map.p({25, 0}), 0.01, kOneStep);
    map.fire({2500});
    EXPECT_NEAR(map.p({25, 0}), oracle::product_rule(0.875, 0.01), 2 * kOneStep)
        << "the update starts at the clamp, not beyond it";
    for (int n = 0; n < 40; ++n) map.fire({2500});
    EXPECT_NEAR(map.p({25, 0}), 0.99, kOneStep);
}

TEST(SonarLayer, OverlappingConesAreSeparateMeasurements) {
    SonarMap once{ExplicitAngles{0.0}};
    SonarMap twice{ExplicitAngles{0.0, 0.0}};
    once.fire({2500});
    once.fire({2500});
    twice.fire({2500, 2500});
    EXPECT_EQ(once.at({25, 0}), twice.at({25, 0}));
    EXPECT_NEAR(twice.p({25, 0}), 0.98, kOneStep);

    SonarMap overlapping{ExplicitAngles{-10 * kDegree, 10 * kDegree}};
    overlapping.fire({2500, 4000});
    const double w = (0.5 + 5.0 / 15.0) / 2.0; // a is 10 degrees for both
    const double expected = oracle::product_rule(0.5 * (1.0 - w), oracle::product_rule(0.5 + 0.5 * w, 0.5));
    EXPECT_NEAR(overlapping.p({25, 0}), expected, 2 * kOneStep) << "an echo in one cone and free in the other";
}

TEST(SonarLayer, SensorsOwnCellIsFreeInEveryDirection) {
    for (const double angle : {0.0, 1.0, kPi}) { // r = 0: w can be 1 and its probability 0
        SonarMap map{ExplicitAngles{angle}};
        map.fire({2500});
        map.fire({2500});
        if (map.at({0, 0}) == kUnknownLogOdds) continue;
        EXPECT_GE(map.p({0, 0}), 0.01 - 1e-4) << angle;
        EXPECT_LT(map.p({0, 0}), 0.5) << angle;
    }
}

TEST(SonarLayer, DoesNotChangeLaserLayers) {
    SonarMap map{UniformAngles{0.0, 1.0, 1}};
    map.fire({2500});
    const auto snapshot = map.snapshot();
    EXPECT_EQ(testing_support::occupancy_at(snapshot, {25, 0}), kUnknownLogOdds);
    EXPECT_EQ(testing_support::himm_at(snapshot, {25, 0}), kUnseenHimm);
    EXPECT_EQ(testing_support::class_at(snapshot, {20, 0}), classify::CellClass::kUnexplored)
        << "sonar does not change classes";
}

const std::map<std::string, SessionOptions> kSonarSettings = {
    {"Defaults", {}},
    {"Others",
     {.sonar_obstacle_thickness = 0.2,
      .sonar_beam_aperture = 0.9,
      .sonar_p_occupied_max = 0.7,
      .sonar_p_min = 0.1,
      .sonar_p_max = 0.85}},
    {"WideClamp", {.sonar_p_occupied_max = 0.999, .sonar_p_min = 1e-6, .sonar_p_max = 1.0 - 1e-6}},
    {"DroppedNoReturns", {.drop_no_return = true}},
};

class SonarLayerWith : public testing::TestWithParam<std::pair<const std::string, SessionOptions>> {};

INSTANTIATE_TEST_SUITE_P(All, SonarLayerWith, testing::ValuesIn(kSonarSettings),
                         [](const auto& tried) { return tried.param.first; });

struct Rng {
    std::mt19937 random;
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
    unsigned below(unsigned n) { return static_cast<unsigned>(random() % n); }
};

/// Returns a ring with up to 20 even or uneven cones, some of them wider than their spacing.
Sensor random_ring(Rng& rng, double range_max) {
    Sensor ring{.id = 1, .kind = SensorKind::kSonar, .range_max = range_max};
    const std::uint32_t cones = 1 + rng.below(20);
    ring.angles = UniformAngles{rng.uniform(-4.0, 4.0), 2 * kPi / cones, cones};
    if (rng.below(2) == 0) {
        ExplicitAngles list(cones);
        for (double& angle : list) angle = rng.uniform(-6.0, 6.0);
        ring.angles = list;
    }
    if (rng.below(2) == 0) ring.aperture = rng.below(4) == 0 ? rng.uniform(1.5, kPi) : rng.uniform(0.05, 1.0);
    if (rng.below(2) == 0) ring.range_min = rng.uniform(0.0, 0.3) * range_max;
    if (rng.below(2) == 0) ring.mount = {rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-kPi, kPi)};
    return ring;
}

std::vector<RangeMm> random_echoes(Rng& rng, const Sensor& ring) {
    std::vector<RangeMm> ranges(beam_count(ring.angles));
    for (auto& range : ranges) {
        const unsigned kind = rng.below(10);
        range = kind == 0 ? kInvalidRange : kind == 1 ? kNoReturn : to_range_mm(rng.uniform(0.0, 1.1) * ring.range_max);
    }
    return ranges;
}

TEST_P(SonarLayerWith, MatchesTheProductRuleForEveryRing) {
    std::size_t firm = 0;
    Rng rng{std::mt19937(17)};
    for (const double cell_size : {0.01, 0.05, 0.1, 0.5}) {
        SessionOptions options = GetParam().second;
        options.cell_size = cell_size;
        const MapConfig config = resolve(options).value();
        for (int round = 0; round < 30; ++round) {
            const Sensor ring = random_ring(rng, cell_size * rng.uniform(4.0, 35.0));
            Projection projection(config);
            oracle::MurphyOracle oracle(config);
            ASSERT_TRUE(projection.apply(RobotJoined{0, "r"}));
            ASSERT_TRUE(projection.apply(SensorDescribed{0, ring}));
            const Pose2 start{rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0), rng.uniform(-kPi, kPi)};
            for (std::uint64_t seq = 1; seq <= 1 + rng.below(5); ++seq) {
                Scan scan{.seq = seq, .sensor = 1, .pose = start, .ranges = random_echoes(rng, ring)};
                scan.pose->x += cell_size * rng.uniform(0.0, 3.0);
                ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
                oracle.add(ring, scan);
            }
            ASSERT_NO_FATAL_FAILURE(oracle.expect_near(projection.snapshot(), "round " + std::to_string(round), firm))
                << "cell size " << cell_size;
        }
    }
    std::cout << firm << " firm cells\n";
    EXPECT_GT(firm, 10'000U);
}

} // namespace
} // namespace scanloom::mapping
