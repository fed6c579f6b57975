#include "lab/recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace scanloom::lab {
namespace {

const Matrix kMatrix = full_matrix();

const NoiseChoice& noise(std::string_view name) {
    return *std::ranges::find_if(kMatrix.noises, [&](const NoiseChoice& choice) { return choice.name == name; });
}

TEST(Matrix, ContainsAllCombinationsOfTheReferenceExperiments) {
    EXPECT_EQ(kMatrix.scenes.size() * kMatrix.cell_sizes.size() * kMatrix.noises.size() * kMatrix.starts.size(), 64U);
    EXPECT_EQ(kMatrix.run_count(), 64U * kMatrix.ray_models.size());
    EXPECT_LT(quick_matrix().run_count(), kMatrix.run_count() / 4);
}

TEST(Drive, DrivesOnceAroundTheRoomWithoutTouchingTheWalker) {
    for (const Start& start : kMatrix.starts) {
        const auto path = drive_from(start, kScansDefault);
        EXPECT_EQ(path.front(), start.pose);
        for (const Point2& corner : {Point2{-4, -4}, Point2{4, -4}, Point2{4, 4}, Point2{-4, 4}}) {
            EXPECT_TRUE(std::ranges::any_of(path, [&](const Pose2& pose) {
                return norm(Point2{pose.x, pose.y} - corner) < 1.5;
            })) << start.name;
        }
        const auto recording = record(kMatrix.scenes[1], path, noise("none"), 0.1, 1);
        EXPECT_GT(recording.of_walkers, 1000U);
        EXPECT_EQ(record(kMatrix.scenes[1], path, noise("gaussian"), 0.1, 1).of_walkers, recording.of_walkers);
        EXPECT_EQ(record(kMatrix.scenes[0], path, noise("none"), 0.1, 1).of_walkers, 0U);
        for (std::size_t n = 0; n < path.size(); ++n) {
            EXPECT_GT(distance(recording.walkers[n].at(0), {path[n].x, path[n].y}), sim::kBodyRadius);
        }
    }
}

TEST(Recordings, ContainExactPosesAndIncreasingNumbers) {
    const auto path = drive_from(kMatrix.starts[1], 20);
    const auto recording = record(kMatrix.scenes[0], path, noise("3_cells"), 0.1, 1);
    ASSERT_EQ(recording.scans.size(), 20U);
    for (std::size_t n = 0; n < 20; ++n) {
        EXPECT_EQ(recording.scans[n].seq, n + 1);
        EXPECT_EQ(recording.scans[n].pose, path[n]);
        EXPECT_EQ(recording.scans[n].ranges.size(), 684U);
        EXPECT_TRUE(recording.walkers[n].empty());
    }
}

TEST(Recordings, DifferOnlyByNoiseAndSeed) {
    const auto path = drive_from(kMatrix.starts[0], 5);
    const auto ranges = [&](std::string_view name, double cell_size, std::uint64_t seed) {
        return record(kMatrix.scenes[0], path, noise(name), cell_size, seed).scans.back().ranges;
    };
    EXPECT_EQ(ranges("none", 0.1, 1), ranges("none", 0.5, 2));
    EXPECT_EQ(ranges("gaussian", 0.1, 1), ranges("gaussian", 0.5, 1));
    EXPECT_NE(ranges("gaussian", 0.1, 1), ranges("gaussian", 0.1, 2));
    EXPECT_NE(ranges("1_cell", 0.1, 1), ranges("1_cell", 0.5, 1));
    EXPECT_NE(ranges("1_cell", 0.1, 1), ranges("3_cells", 0.1, 1));
}

TEST(Recordings, DynamicSceneContainsAMovingVisibleWalker) {
    const auto path = drive_from(kMatrix.starts[0], kScansDefault);
    const auto empty = record(kMatrix.scenes[0], path, noise("none"), 0.1, 1);
    const auto walked = record(kMatrix.scenes[1], path, noise("none"), 0.1, 1);
    EXPECT_NEAR(norm(walked.walkers[31].at(0).centre - walked.walkers[1].at(0).centre), 3.0, 1e-6);
    std::size_t scans_with_walker = 0;
    for (std::size_t n = 0; n < path.size(); ++n) scans_with_walker += walked.scans[n].ranges != empty.scans[n].ranges;
    EXPECT_GT(scans_with_walker, kScansDefault / 8);
    EXPECT_LT(scans_with_walker, kScansDefault);
}

TEST(Recordings, GaussianNoiseDropsNoReturns) {
    const auto path = drive_from(kMatrix.starts[0], 1);
    const auto exact = record(kMatrix.scenes[0], path, noise("none"), 0.1, 1).scans[0].ranges;
    const auto noisy = record(kMatrix.scenes[0], path, noise("gaussian"), 0.1, 1).scans[0].ranges;
    EXPECT_GT(std::ranges::count(exact, kNoReturn), 0);
    EXPECT_EQ(std::ranges::count(noisy, kNoReturn), 0);
    EXPECT_GT(std::ranges::count(noisy, kInvalidRange), 0);
}

} // namespace
} // namespace scanloom::lab
