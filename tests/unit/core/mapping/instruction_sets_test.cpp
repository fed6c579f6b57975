#include "core/mapping/chunk_kernels.hpp"
#include "core/mapping/projection.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/instruction_set.hpp"
#include "tests/support/random_angles.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

/// Compares every instruction set of this machine with the definitions and with the other instruction sets.
namespace scanloom::mapping {
namespace {

class InstructionSet : public testing::TestWithParam<std::string_view> {
protected:
    void SetUp() override { simd::use_instruction_set(GetParam()); }
    void TearDown() override { simd::use_instruction_set({}); }
};

INSTANTIATE_TEST_SUITE_P(All, InstructionSet, testing::ValuesIn(simd::instruction_sets()),
                         [](const auto& tried) { return std::string(tried.param); });

TEST_P(InstructionSet, IsTheSelectedOne) { EXPECT_EQ(simd::instruction_set(), GetParam()); }

/// Returns digests of maps with scans of every sensor shape and cell size: hits, no-returns and invalid readings.
std::string digests_of_random_scans(unsigned shape, const SessionOptions& options) {
    std::mt19937 random(shape);
    const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    std::string name;
    Sensor sensor;
    sensor.angles = testing_support::random_angles(random, shape, name);
    sensor.range_max = *options.cell_size * 200.0;
    Projection projection(resolve(options).value());
    EXPECT_TRUE(projection.apply(RobotJoined{0, "r"}));
    EXPECT_TRUE(projection.apply(SensorDescribed{0, sensor}));
    for (std::uint64_t seq = 1; seq <= 6; ++seq) {
        Scan scan{.seq = seq, .pose = Pose2{uniform(-3.0, 3.0), uniform(-3.0, 3.0), uniform(-3.0, 3.0)}};
        const double wall = uniform(0.1, 0.9) * sensor.range_max;
        for (std::size_t beam = 0; beam < beam_count(sensor.angles); ++beam) {
            const auto kind = random() % 16;
            const double z = random() % 8 == 0 ? uniform(0.0, sensor.range_max) : wall * uniform(0.99, 1.01);
            scan.ranges.push_back(kind == 0 ? kInvalidRange : kind == 1 ? kNoReturn : to_range_mm(z));
        }
        EXPECT_TRUE(projection.apply(ScanTaken{0, std::move(scan)}));
    }
    return testing_support::digests_of(projection.snapshot());
}

using Digests = std::map<std::string, std::string>; // of each map by its name

Digests digests_of_random_maps() {
    Digests digests;
    for (unsigned shape = 0; shape < testing_support::kAngleShapes; ++shape) {
        for (const double cell_size : {0.01, 0.05, 0.5}) {
            for (const auto class_source : {ClassSource::kOccupancy, ClassSource::kHimm}) {
                const SessionOptions options{.cell_size = cell_size, .class_source = class_source};
                const bool by_himm = class_source == ClassSource::kHimm;
                digests[fmt::format("shape {}, {} m{}", shape, cell_size, by_himm ? ", classes by HIMM" : "")] =
                    digests_of_random_scans(shape, options);
            }
        }
    }
    return digests;
}

/// Compares maps by the selected instruction set with those by the scalar code, which are computed once.
void expect_maps_of_scalar_code(Digests (*digests_of_maps)()) {
    static std::map<Digests (*)(), Digests> by_scalar_code;
    const Digests digests = digests_of_maps();
    Digests& expected = by_scalar_code[digests_of_maps];
    if (expected.empty()) {
        simd::use_instruction_set({});
        simd::use_instruction_set(simd::instruction_sets().back());
        expected = digests_of_maps();
    }
    ASSERT_EQ(digests.size(), expected.size());
    for (const auto& [map, digest] : digests) EXPECT_EQ(digest, expected.at(map)) << map;
}

TEST_P(InstructionSet, CreatesBitwiseEqualMaps) { expect_maps_of_scalar_code(digests_of_random_maps); }

/// Returns digests of scans whose sensor is at a centre or corner of a cell, whose sector edges pass through centres of
/// other cells, and whose bands begin or end there, so that the result depends on the rounding of each crossing.
std::string digests_of_scans_through_centres(unsigned seed) {
    struct Direction {
        int x, y, length; // whole numbers all three
    };
    constexpr Direction kDirections[] = {{3, 4, 5},   {4, 3, 5},    {5, 12, 13},  {12, 5, 13}, {8, 15, 17},
                                         {15, 8, 17}, {20, 21, 29}, {21, 20, 29}, {1, 0, 1},   {0, 1, 1}};
    constexpr double kAperture = 0.04;
    std::mt19937 random(seed);
    const double cell = std::array{0.25, 0.5, 1.0}[random() % 3];
    const double narrow = cell * static_cast<double>(1 + random() % 4);
    const double wide = narrow + cell * static_cast<double>(random() % 3);
    Sensor sensor;
    sensor.range_max = 150.0 * cell;
    ExplicitAngles angles;
    Scan scan;
    const auto half_cells = [&] { return 0.5 * cell * static_cast<double>(random() % 7); };
    for (const Direction& direction : kDirections) {
        for (const double turned : {0.0, 0.5, 1.0, 1.5}) { // multiples of pi
            const double edge = std::atan2(direction.y, direction.x) + turned * std::numbers::pi;
            const double corner =
                cell * direction.length * static_cast<double>(1 + random() % (140 / direction.length));
            for (const double side : {-0.5, 0.5}) { // the edge is halfway between two beams
                angles.push_back(edge + side * kAperture);
                const double ahead = 0.5 * (random() % 2 == 0 ? narrow : wide) * (random() % 2 == 0 ? 1.0 : -1.0);
                scan.ranges.push_back(random() % 6 == 0 ? kInvalidRange : to_range_mm(corner + ahead + half_cells()));
            }
        }
    }
    sensor.angles = angles;
    scan.seq = 1;
    scan.pose = {half_cells(), half_cells(), 0.0};
    const SessionOptions options{.cell_size = cell,
                                 .obstacle_thickness = narrow,
                                 .beam_aperture = kAperture,
                                 .himm_obstacle_thickness = wide,
                                 .himm_beam_aperture = kAperture};
    Projection projection(resolve(options).value());
    EXPECT_TRUE(projection.apply(RobotJoined{0, "r"}));
    EXPECT_TRUE(projection.apply(SensorDescribed{0, sensor}));
    EXPECT_TRUE(projection.apply(ScanTaken{0, std::move(scan)}));
    return testing_support::digests_of(projection.snapshot());
}

Digests digests_of_maps_through_centres(unsigned seeds) {
    Digests digests;
    for (unsigned seed = 0; seed < seeds; ++seed) {
        digests[fmt::format("seed {}", seed)] = digests_of_scans_through_centres(seed);
    }
    return digests;
}

TEST_P(InstructionSet, CreatesEqualMapsForEdgesThroughCentres) {
    expect_maps_of_scalar_code([] { return digests_of_maps_through_centres(200); });
}

class InstructionSetTrials : public InstructionSet {};

INSTANTIATE_TEST_SUITE_P(All, InstructionSetTrials, testing::ValuesIn(simd::instruction_sets()),
                         [](const auto& tried) { return std::string(tried.param); });

TEST_P(InstructionSetTrials, CreatesEqualMapsForManyEdgesThroughCentres) {
    expect_maps_of_scalar_code([] { return digests_of_maps_through_centres(1500); });
}

/// A chunk with random values and with verdicts on some of its cells; some rows are entirely free.
struct RandomChunk {
    explicit RandomChunk(unsigned seed) {
        std::mt19937_64 random(seed);
        for (auto& cell : chunk.occupancy) cell = random() % 5 == 0 ? kUnknownLogOdds : static_cast<LogOdds>(random());
        for (auto& count : chunk.himm) count = random() % 5 == 0 ? kUnseenHimm : static_cast<HimmCount>(random() % 16);
        for (std::size_t j = 0; j < verdicts.free.size(); ++j) {
            chunk.occ_types.free[j] = random();
            chunk.occ_types.occupied[j] = random() & ~chunk.occ_types.free[j];
            verdicts.free[j] = j % 3 == 0 ? ~std::uint64_t{0} : j % 3 == 1 ? random() : 0;
            verdicts.occupied[j] = j % 3 == 0 || j % 4 == 0 ? 0 : random() & ~verdicts.free[j];
            verdicts.free_rows |= std::uint64_t{verdicts.free[j] != 0} << j;
            verdicts.occupied_rows |= std::uint64_t{verdicts.occupied[j] != 0} << j;
        }
    }

    template <class Check>
    void for_each_cell(Check&& check) const {
        for (std::int32_t n = 0; n < static_cast<std::int32_t>(LaserChunk::kCells); ++n) {
            check(static_cast<std::size_t>(n), grid::Cell{n % grid::kChunkSide, n / grid::kChunkSide});
        }
    }

    LaserChunk chunk;
    ChunkVerdicts verdicts;
};

/// Millions of assertions would take longer than the comparison.
void expect_value(int value, int expected, std::size_t n, int before) {
    if (value == expected) return;
    ADD_FAILURE() << "cell " << n << " is " << value << ", not " << expected << "; was " << before;
}

OccupancyRule rule_of(double prior, double low, double high, double free, double occupied) {
    MapConfig config;
    config.p_prior = prior;
    config.p_min = low;
    config.p_max = high;
    config.p_free = free;
    config.p_occupied = occupied;
    return OccupancyRule(config);
}

/// Returns repeated verdicts, which saturate cells, followed by others that change them again.
std::vector<ChunkVerdicts> random_verdicts(unsigned seed) {
    std::vector<ChunkVerdicts> all;
    for (unsigned n = 0; n < 4; ++n) all.insert(all.end(), 6, RandomChunk(100 * seed + n).verdicts);
    return all;
}

TEST_P(InstructionSet, AddsEvidenceAsDefined) {
    const double nearly_one = 0.99999988;
    for (const auto& rule :
         {rule_of(0.5, 0.001, 0.999, 0.1, 0.9), rule_of(0.3, 0.01, 0.9, 0.2, 0.6), rule_of(0.2, 0.01, 0.99, 0.4, 0.9),
          rule_of(1.0 - nearly_one, 1.0 - nearly_one, nearly_one, 1.0 - nearly_one, nearly_one),
          rule_of(nearly_one, 1.0 - nearly_one, nearly_one, 1.0 - nearly_one, nearly_one)}) {
        RandomChunk random(7);
        for (std::size_t j = 0; j < 32; ++j) std::fill_n(&random.chunk.occupancy[64 * j], 64, LogOdds{-32767});
        LaserChunk after = random.chunk;
        for (const ChunkVerdicts& verdicts : random_verdicts(1)) {
            const LaserChunk before = after;
            simd::add_evidence(after, verdicts, rule);
            random.for_each_cell([&](std::size_t n, grid::Cell cell) {
                const bool is_free = grid::is_set(verdicts.free, cell);
                const bool is_occupied = grid::is_set(verdicts.occupied, cell);
                const LogOdds known = before.occupancy[n];
                const int from = known == kUnknownLogOdds ? rule.prior : known;
                const int to = std::clamp<int>(from + (is_free ? rule.free : rule.occupied), rule.l_min, rule.l_max);
                expect_value(after.occupancy[n], is_free || is_occupied ? to : known, n, known);
            });
        }
    }
}

TEST_P(InstructionSet, CountsHitsAsDefined) {
    MapConfig config;
    for (const auto& steps : {std::pair{3, 1}, {15, 15}, {1, 4}}) {
        config.himm_increment = steps.first;
        config.himm_decrement = steps.second;
        const RandomChunk random(7);
        LaserChunk after = random.chunk;
        for (const ChunkVerdicts& verdicts : random_verdicts(2)) {
            const LaserChunk before = after;
            simd::count_hits(after, verdicts, HimmRule(config));
            random.for_each_cell([&](std::size_t n, grid::Cell cell) {
                const bool is_free = grid::is_set(verdicts.free, cell);
                const bool is_occupied = grid::is_set(verdicts.occupied, cell);
                const int known = before.himm[n];
                const int from = known == kUnseenHimm ? 0 : known;
                const int to = std::clamp(is_free ? from - steps.second : from + steps.first, 0, 15);
                expect_value(after.himm[n], is_free || is_occupied ? to : known, n, known);
            });
        }
    }
}

TEST_P(InstructionSet, SaturatedCellsIgnoreFurtherEqualVerdicts) {
    RandomChunk random(9);
    random.verdicts.occupied.fill(0);
    random.verdicts.occupied_rows = 0;
    LaserChunk chunk = random.chunk;
    EXPECT_FALSE(simd::is_saturated(chunk, random.verdicts, random.verdicts));
    for (int n = 0; n < 30; ++n) {
        simd::add_evidence(chunk, random.verdicts, OccupancyRule({}));
        simd::count_hits(chunk, random.verdicts, HimmRule({}));
    }
    EXPECT_TRUE(simd::is_saturated(chunk, random.verdicts, random.verdicts));
    const grid::Cell cell{3, 0}; // of a row whose cells are all free
    ChunkVerdicts hit;
    grid::set(hit.occupied, cell, true);
    hit.occupied_rows = 1;
    simd::add_evidence(chunk, hit, OccupancyRule({}));
    EXPECT_FALSE(simd::is_saturated(chunk, random.verdicts, random.verdicts));
}

/// Applies the definition to one cell.
template <class Value>
classify::OccType type_after(classify::OccType before, Value value, const classify::Hysteresis<Value>& rule) {
    using classify::OccType;
    if (value == rule.unseen) return before;
    if (value >= rule.occupied) return OccType::kOccupied;
    return value <= (before == OccType::kUnexplored ? rule.first_free : rule.free) ? OccType::kFree : before;
}

TEST_P(InstructionSet, UpdatesTypesAsDefined) {
    const classify::Hysteresis<LogOdds> by_occupancy{1200, -900, -900, kUnknownLogOdds};
    const classify::Hysteresis<HimmCount> by_himm{8, 4, 0, kUnseenHimm};
    for (unsigned seed = 0; seed < 20; ++seed) {
        const RandomChunk before(seed);
        const auto& touched = before.verdicts.free;
        LaserChunk by_odds = before.chunk;
        LaserChunk by_count = before.chunk;
        simd::update_types(by_odds, touched, by_occupancy);
        simd::update_types(by_count, touched, by_himm);
        before.for_each_cell([&](std::size_t n, grid::Cell cell) {
            const auto type = before.chunk.occ_types.at(cell);
            const bool counts = grid::is_set(touched, cell);
            ASSERT_EQ(by_odds.occ_types.at(cell),
                      counts ? type_after(type, before.chunk.occupancy[n], by_occupancy) : type)
                << "cell " << n;
            ASSERT_EQ(by_count.occ_types.at(cell), counts ? type_after(type, before.chunk.himm[n], by_himm) : type)
                << "cell " << n;
        });
        for (std::size_t j = 0; j < touched.size(); ++j) {
            EXPECT_EQ(by_odds.occ_types.free[j] & by_odds.occ_types.occupied[j], 0U);
        }
    }
}

} // namespace
} // namespace scanloom::mapping
