#include "lab/trajectory_map.hpp"

#include <opencv2/imgcodecs.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scanloom::lab {
namespace {

/// A laser that sees a wall 2 m away, in a fan of +- 0.3 rad or all around.
std::vector<robot::Observation> scans(std::size_t count, bool all_around = false) {
    Sensor sensor;
    sensor.angles = all_around ? UniformAngles{-3.1, 0.2, 31} : UniformAngles{-0.3, 0.02, 31};
    sensor.range_max = 10.0;
    const auto laser = std::make_shared<const Sensor>(sensor);
    std::vector<robot::Observation> scans(count, {laser, {}});
    for (auto& [unused, scan] : scans) {
        scan.ranges.assign(31, 2000);
        scan.odometry = Pose2{90, 90, 0};
    }
    return scans;
}

cv::Mat decoded(const MapPicture& map) {
    const cv::Mat picture = cv::imdecode(map.png, cv::IMREAD_GRAYSCALE);
    EXPECT_EQ(picture.cols, map.width);
    EXPECT_EQ(picture.rows, map.height);
    return picture;
}

TEST(TrajectoryMap, ShowsScansAtTheirPoses) {
    // The robot looks along x from the origin, and along y from 10 m to the right.
    const std::vector<std::optional<Pose2>> poses{Pose2{0.025, 0.025, 0}, Pose2{10.025, 0.025, M_PI / 2}};
    const auto map = draw_map(scans(2), poses, 1000);
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->cell_size, 0.05);
    const cv::Mat picture = decoded(*map);
    EXPECT_NEAR(map->width, (10.0 + 2.0 * std::sin(0.3)) / 0.05, 3.0);
    EXPECT_NEAR(map->height, (2.0 + 2.0 * std::sin(0.3)) / 0.05, 5.0);
    const int middle = map->height - static_cast<int>(2.0 * std::sin(0.3) / 0.05) - 1; // row of y = 0
    EXPECT_GT(picture.at<std::uint8_t>(middle, 20), 200) << "free, 1 m ahead of the first robot";
    EXPECT_LT(picture.at<std::uint8_t>(middle, 40), 60) << "the wall";
    EXPECT_EQ(picture.at<std::uint8_t>(middle, 100), 128) << "not observed";
    EXPECT_GT(picture.at<std::uint8_t>(middle - 20, 200), 200) << "free, 1 m ahead of the second robot";
    EXPECT_LT(picture.at<std::uint8_t>(1, 200), 60) << "its wall";
}

TEST(TrajectoryMap, LeavesOutScansWithoutPoses) {
    const std::vector<std::optional<Pose2>> second{std::nullopt, Pose2{}};
    const std::vector<std::optional<Pose2>> both{Pose2{}, Pose2{}};
    const std::vector<std::optional<Pose2>> one{Pose2{}};
    EXPECT_EQ(draw_map(scans(2), second, 1000)->png, draw_map(scans(1), one, 1000)->png);
    EXPECT_NE(draw_map(scans(2), both, 1000)->png, draw_map(scans(1), one, 1000)->png);
    const std::vector<std::optional<Pose2>> none(2);
    EXPECT_EQ(draw_map(scans(2), none, 1000).error().code, Errc::kNotFound);
}

TEST(TrajectoryMap, CellsGrowUntilThePictureFits) {
    const std::vector<std::optional<Pose2>> poses{Pose2{}, Pose2{40, 0, 0}}; // 44 m
    EXPECT_EQ(draw_map(scans(2, true), poses, 900)->cell_size, 0.05);
    const auto coarse = draw_map(scans(2, true), poses, 600);
    ASSERT_TRUE(coarse);
    EXPECT_EQ(coarse->cell_size, 0.1);
    EXPECT_NEAR(coarse->width, 440, 4);
    EXPECT_EQ(draw_map(scans(2, true), poses, 100)->cell_size, 0.5);
    const auto failed = draw_map(scans(2, true), poses, 30);
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, Errc::kTooLarge);
    EXPECT_THAT(failed.error().message, testing::HasSubstr("larger than 30 x 30 cells of 1 m"));
}

} // namespace
} // namespace scanloom::lab
