#include "lab/integrate_recording.hpp"

#include "lab/map_cells.hpp"

#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

/// A robot at (0.05, 0.05) with one beam detects an object at a distance of 1 m, three times.
Recording one_beam(double range_max = 5.0) {
    Recording recording;
    recording.laser.angles = UniformAngles{0.0, 0.1, 1};
    recording.laser.range_max = range_max;
    for (std::uint64_t seq = 1; seq <= 3; ++seq) {
        Scan scan;
        scan.seq = seq;
        scan.pose = {0.05, 0.05, 0.0};
        scan.ranges = {1000};
        recording.scans.push_back(scan);
        recording.walkers.emplace_back();
    }
    return recording;
}

SessionOptions cells_of(double size) {
    SessionOptions options;
    options.cell_size = size;
    return options;
}

TEST(IntegrateRecording, CountsTheTimeOfScansOnly) {
    double clock = 0.0;
    std::vector<std::size_t> scan_counts;
    const auto seconds = integrate_recording(
        one_beam(), cells_of(0.1), [&] { return clock += 1.0; },
        [&](std::size_t scans, mapping::Projection&) {
            clock += 100.0;
            scan_counts.push_back(scans);
        });
    ASSERT_TRUE(seconds);
    EXPECT_EQ(*seconds, (std::vector<double>{1.0, 1.0, 1.0}));
    EXPECT_EQ(scan_counts, (std::vector<std::size_t>{1, 2, 3}));
}

TEST(IntegrateRecording, InvalidSettingsAreRefused) {
    const auto refused = integrate_recording(
        one_beam(), cells_of(0.0), [] { return 0.0; }, [](std::size_t, mapping::Projection&) {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kInvalidField);
}

TEST(MapCells, AreTheMapsCellsInTheBox) {
    std::optional<mapping::Snapshot> end;
    const auto keep = [&](std::size_t, mapping::Projection& projection) { end = projection.snapshot(); };
    ASSERT_TRUE(integrate_recording(
        one_beam(), cells_of(0.1), [] { return 0.0; }, keep));
    const auto occupancy = occupancy_of(*end, {0, -1, 12, 2});
    const auto map = states_of(occupancy);
    for (std::int32_t i = 0; i < 10; ++i) EXPECT_EQ(map.at({i, 0}), CellState::kFree) << i;
    EXPECT_EQ(map.at({10, 0}), CellState::kOccupied);
    EXPECT_EQ(map.at({11, 0}), CellState::kUnknown);
    EXPECT_EQ(map.at({5, 1}), CellState::kUnknown);
    EXPECT_EQ(touched_cells(occupancy), 11U);
    EXPECT_EQ(touched_cells(occupancy_of(*end, {0, 0, 5, 1})), 5U);
}

TEST(MapCells, AreClassifiedByTheClassThresholds) {
    const auto l = [](double p) { return mapping::to_fixed(mapping::log_odds_of(p)); };
    LogOddsGrid occupancy({0, 0, 5, 1}, mapping::kUnknownLogOdds);
    occupancy.values = {l(0.66), l(0.64), l(0.36), l(0.34), mapping::kUnknownLogOdds};
    EXPECT_EQ(states_of(occupancy).values, (std::vector{CellState::kOccupied, CellState::kUnknown, CellState::kUnknown,
                                                        CellState::kFree, CellState::kUnknown}));
    EXPECT_EQ(touched_cells(occupancy), 4U);
}

} // namespace
} // namespace scanloom::lab
