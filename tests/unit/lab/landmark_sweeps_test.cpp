#include "lab/landmark_comparison.hpp"

#include "lab/door_room.hpp"

#include "tests/unit/lab/drawn_clouds.hpp"

#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

TEST(ToleranceSweep, CombinesTheMatchesOfAllPairs) {
    const auto first = seen_bars({{0.0, 0.0}, {4.0, 0.0}});
    const auto second = seen_bars({{0.0, 0.06}, {4.0, 0.45}});
    const auto other = seen_bars({{0.0, 0.0}, {4.0, 9.0}});
    const std::vector<std::pair<const SeenLandmarks*, const SeenLandmarks*>> pairs{{&first, &second}, {&first, &other}};
    const auto rows = sweep_tolerances(pairs).value();
    ASSERT_EQ(rows.size(), 10U);
    EXPECT_DOUBLE_EQ(rows[0].tolerance, 0.1);
    EXPECT_EQ(rows[0].metrics.matched, 2U) << "matches at 0.06 m and 0 m";
    EXPECT_DOUBLE_EQ(*rows[0].metrics.persistence, 0.5);
    EXPECT_DOUBLE_EQ(*rows[0].metrics.stability, 0.5) << "0.06 m is more than half of 0.1 m";
    EXPECT_NEAR(*rows[0].metrics.distance_mean, 0.03, 1e-9);
    EXPECT_NEAR(*rows[0].metrics.distance_sigma, 0.03, 1e-9);
    EXPECT_EQ(rows[3].metrics.matched, 2U) << "tolerance 0.4 m";
    EXPECT_EQ(rows[4].metrics.matched, 3U) << "tolerance 0.5 m";
    EXPECT_NEAR(*rows[4].metrics.distance_mean, 0.17, 1e-9);
    EXPECT_DOUBLE_EQ(*rows[9].metrics.stability, 1.0);
}

class StandingLidar : public testing::Test {
protected:
    LidarCapture capture(std::size_t turns, const std::optional<sim::Noise>& noise = sim::Noise{}) {
        return take_capture(make_door_room(Door::kClosed), kDoorRoomPlaces[0], turns, noise, random_);
    }

private:
    sim::Random random_{1};
};

TEST_F(StandingLidar, CountsReadingsPerTurnAndReportsMedianTimes) {
    // Each timing reads the clock twice; the second readings are 1, 1, 1, 9 and 9 ms later.
    int clock_reads = 0;
    double time = 0.0;
    const auto now = [&] {
        const int timing = clock_reads / 2 % kTimings;
        if (clock_reads++ % 2 == 1) time += timing < 3 ? 0.001 : 0.009;
        return time;
    };
    const auto taken = capture(120);
    const auto rows = sweep_readings(taken, now).value();
    ASSERT_EQ(rows.size(), 2U) << "rows for 50 and 100 readings; the capture has fewer than 200";
    for (const auto& row : rows) {
        EXPECT_EQ(row.points, row.readings * 360U) << "every beam in a closed room has a return";
        EXPECT_NEAR(row.milliseconds, 1.0, 1e-9);
        EXPECT_GT(row.landmarks, 4U);
    }
    EXPECT_EQ(rows[1].readings, 100U);
    EXPECT_NEAR(static_cast<double>(rows[1].robot_bytes), 2.0 * static_cast<double>(rows[0].robot_bytes), 100.0);
    EXPECT_GT(rows[1].server_bytes, rows[0].server_bytes);
}

TEST_F(StandingLidar, MedianFiltersSmoothWallsAndRoundCorners) {
    const auto exact = capture(1, std::nullopt).scans.front();
    const auto rows = sweep_windows(capture(5), exact);
    ASSERT_EQ(rows.size(), 10U);
    EXPECT_EQ(rows[0].window, 1U);
    EXPECT_EQ(rows[0].figures, (landmarks::FilterFigures{0.0, 0.0, 0.0})) << "a window of one changes nothing";
    EXPECT_NEAR(rows[0].wall_error, 0.0135, 0.005) << "the median of 2 cm noise";
    EXPECT_LT(rows[2].wall_error, rows[0].wall_error);
    EXPECT_GT(rows.back().corner_error, 10.0 * rows[0].corner_error);
    for (std::size_t n = 1; n < rows.size(); ++n) EXPECT_GT(rows[n].figures.rmse, rows[n - 1].figures.rmse);
    EXPECT_GT(*rows[3].figures.noise_reduction_x, 0.3);
    EXPECT_GT(*rows[3].figures.noise_reduction_y, 0.3);
}

TEST_F(StandingLidar, WindowOfOneHasNoErrorWithoutNoise) {
    const auto taken = capture(2, std::nullopt);
    const auto rows = sweep_windows(taken, taken.scans.front());
    EXPECT_EQ(rows[0].wall_error, 0.0);
    EXPECT_EQ(rows[0].corner_error, 0.0);
    EXPECT_GT(rows.back().corner_error, 0.1);
}

} // namespace
} // namespace scanloom::lab
