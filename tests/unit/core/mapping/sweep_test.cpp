#include "core/mapping/sweep/sweep.hpp"

#include "tests/support/angles.hpp"
#include "tests/support/kernel_against_oracle.hpp"
#include "tests/support/random_angles.hpp"

#include <gtest/gtest.h>

#include <new>
#include <random>

namespace scanloom::mapping {
namespace {

class RandomCases {
public:
    explicit RandomCases(unsigned seed) : random_(seed) {}

    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

    Case next(unsigned shape) {
        Case c;
        c.angles = testing_support::random_angles(random_, shape, c.shape);
        c.cell_size = std::array{0.01, 0.05, 0.1, 0.5}[below(4)];
        c.range_max = c.cell_size * uniform(4.0, 32.0);
        c.range_min = below(2) == 0 ? 0.0 : c.range_max * uniform(0.0, 0.3);
        c.drop_no_return = below(4) == 0;
        c.thickness = below(2) == 0 ? 0.1 : c.cell_size * uniform(0.2, 6.0);
        c.aperture = below(3) == 0 ? uniform(0.001, 1.5) : kDegree;
        c.T_map_sensor = {uniform(-20.0, 20.0), uniform(-20.0, 20.0), uniform(-kPi, kPi)};
        if (below(4) == 0) { // on centres and borders of cells, with axis-aligned headings
            c.T_map_sensor = {(below(41) - 20.0) * c.cell_size / 2, (below(41) - 20.0) * c.cell_size / 2,
                              below(8) * kPi / 4};
        }
        c.ranges.resize(beam_count(c.angles));
        for (auto& range : c.ranges) {
            const unsigned kind = below(10);
            range = kind == 0 ? kInvalidRange : kind == 1 ? kNoReturn : to_range_mm(uniform(0.0, 1.15) * c.range_max);
        }
        return c;
    }

private:
    std::mt19937 random_;
};

/// Compares `rounds` random scans of every shape with a naive double loop over cells and beams.
void compare_with_oracle(int rounds) {
    std::size_t firm = 0;
    for (unsigned shape = 0; shape < testing_support::kAngleShapes; ++shape) {
        RandomCases cases(100 + shape);
        for (int round = 0; round < rounds; ++round) {
            const Case c = cases.next(shape);
            ASSERT_NO_FATAL_FAILURE(expect_equal_to_oracle(c, firm)) << "round " << round;
        }
    }
    EXPECT_GT(firm, 3'000U * static_cast<unsigned>(rounds)) << "too few cells have a firm verdict to compare";
}

TEST(Sweep, MatchesTheNaiveDoubleLoop) { compare_with_oracle(15); }

TEST(SweepTrials, MatchesTheNaiveDoubleLoopOnManyScans) { compare_with_oracle(300); }

TEST(Sweep, IsExactWithManyStrips) {
    RandomCases cases(7);
    Case c = cases.next(0);
    c.shape = "a whole turn";
    c.angles = UniformAngles{-kPi, kPi / 200, 400};
    c.cell_size = 0.01;
    c.range_min = 0.0;
    c.range_max = 9.0;
    c.T_map_sensor = {3.003, -2.007, 0.4};
    c.ranges.assign(400, 0);
    for (auto& range : c.ranges) range = to_range_mm(cases.uniform(7.6, 8.2));
    const auto ring = make_fan_ring(make_beam_fan(c.angles, c.aperture));
    const Sweep::Band band{&ring, c.thickness};
    ASSERT_GE(Sweep({c.ranges, c.T_map_sensor, {0.0, c.range_max, false}, c.cell_size}, {&band, 1}).strips(), 2U);
    std::size_t firm = 0;
    expect_equal_to_oracle(c, firm, Beams::kIndexed);
    EXPECT_GT(firm, 1'000'000U);
}

TEST(Sweep, AbortedSweepDoesNotAffectTheNext) {
    RandomCases cases(8);
    const Case c = cases.next(0);
    const auto whole = changed_cells(run_kernel(c));
    const auto ring = make_fan_ring(make_beam_fan(c.angles, c.aperture));
    const Sweep::Band band{&ring, c.thickness};
    Sweep sweep({c.ranges, c.T_map_sensor, {c.range_min, c.range_max, false}, c.cell_size}, {&band, 1});
    EXPECT_THROW(sweep.visit(0, [](grid::ChunkKey, std::span<const ChunkVerdicts>) { throw std::bad_alloc(); }),
                 std::bad_alloc);
    EXPECT_EQ(changed_cells(run_kernel(c)), whole);
}

/// A sensor at the centre of cell (0, 0) with one beam along +x.
Case one_beam(double reading_m) {
    Case c;
    c.shape = "one beam";
    c.angles = UniformAngles{0.0, 1.0, 1};
    c.aperture = 3 * kDegree;
    c.cell_size = 0.1;
    c.range_max = 2.0;
    c.T_map_sensor = {0.05, 0.05, 0.0};
    c.ranges = {to_range_mm(reading_m)};
    return c;
}

oracle::Verdict cell(const Verdicts& verdicts, int i, int j) { return verdicts.at({i, j}); }

TEST(Sweep, FreesCellsUpToTheHitAndMarksTheBand) {
    const auto verdicts = run_kernel(one_beam(1.0));
    EXPECT_EQ(cell(verdicts, 9, 0), oracle::Verdict::kFree);
    EXPECT_EQ(cell(verdicts, 10, 0), oracle::Verdict::kOccupied);
    EXPECT_EQ(cell(verdicts, 11, 0), oracle::Verdict::kNothing);
    EXPECT_EQ(cell(verdicts, -1, 0), oracle::Verdict::kNothing) << "the cell is behind the sensor";
}

TEST(Sweep, ReadingBeyondTheRangeFreesTheBeamAndMarksNone) {
    for (const double reading : {2.0, 2.5, HUGE_VAL}) {
        const auto verdicts = run_kernel(one_beam(reading));
        EXPECT_EQ(cell(verdicts, 19, 0), oracle::Verdict::kFree) << reading;
        for (const auto& [at, verdict] : changed_cells(verdicts)) EXPECT_EQ(verdict, oracle::Verdict::kFree) << reading;
    }
}

} // namespace
} // namespace scanloom::mapping
