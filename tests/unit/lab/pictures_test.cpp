#include "lab/pictures.hpp"

#include "lab/integrate_recording.hpp"

#include <opencv2/imgcodecs.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace scanloom::lab {
namespace {

constexpr double kMiddle = 0.0125; // centre of a pixel

/// A robot drives 1 m along x and detects an object 1.5 m ahead; a walker stands next to the path.
Recording short_drive() {
    Recording recording;
    recording.laser.angles = UniformAngles{-0.3, 0.02, 31};
    recording.laser.range_max = 3.0;
    for (int n = 0; n <= 10; ++n) {
        Scan scan;
        scan.seq = static_cast<std::uint64_t>(n + 1);
        scan.pose = {0.0125 + 0.1 * n, kMiddle, 0.0};
        scan.ranges.assign(31, 1500);
        recording.scans.push_back(scan);
        recording.walkers.push_back({{{1.0, -0.8}, 0.25}});
    }
    return recording;
}

cv::Mat strip_of(double cell_size) {
    const Recording recording = short_drive();
    std::vector<Moment> moments;
    SessionOptions options;
    options.cell_size = cell_size;
    const auto keep = [&](std::size_t scans, mapping::Projection& projection) {
        if (scans == 1 || scans == 11) moments.push_back({projection.snapshot(), scans});
    };
    EXPECT_TRUE(integrate_recording(
        recording, options, [] { return 0.0; }, keep));
    return cv::imdecode(strip_png(moments, recording, {-0.5, -1.2, 3.0, 1.0}), cv::IMREAD_COLOR);
}

const cv::Vec3b kWhite(255, 255, 255);
const cv::Vec3b kGrey(128, 128, 128);
const cv::Vec3b kBlue(200, 100, 0);
const cv::Vec3b kRed(40, 30, 220);
const cv::Vec3b kOrange(0, 140, 255);

/// Returns the pixel at a place of the map, in the first or second moment.
cv::Vec3b at(const cv::Mat& strip, double x, double y, int moment) {
    return strip.at<cv::Vec3b>(static_cast<int>((1.0 - y) * 40.0),
                               static_cast<int>((x + 0.5) * 40.0) + moment * (140 + 8));
}

class StripsAt : public testing::TestWithParam<double> {};

TEST_P(StripsAt, ShowMapTrajectoryPointsRobotAndWalkerPerMoment) {
    const cv::Mat strip = strip_of(GetParam());
    ASSERT_EQ(strip.cols, 140 + 8 + 140);
    ASSERT_EQ(strip.rows, 88);
    const auto is_light = [&](double x, double y, int moment) { return at(strip, x, y, moment)[0] > 220; };
    EXPECT_TRUE(is_light(1.0, 0.05, 0)) << "free after one scan";
    EXPECT_TRUE(is_light(2.0, 0.05, 1)) << "free after all scans";
    EXPECT_EQ(at(strip, 2.3, kMiddle, 0), kGrey) << "not yet observed";
    EXPECT_EQ(at(strip, 1.51, kMiddle, 0), kRed) << "the newest scan";
    EXPECT_EQ(at(strip, 2.51, kMiddle, 1), kRed);
    EXPECT_NE(at(strip, 1.51, kMiddle, 1), kRed) << "older scans are visible in the map only";
    EXPECT_EQ(at(strip, 0.0, kMiddle, 0), kBlue) << "the robot";
    EXPECT_EQ(at(strip, 1.0, kMiddle, 1), kBlue);
    EXPECT_EQ(at(strip, 0.4, kMiddle, 1), kBlue) << "the trajectory so far";
    EXPECT_EQ(at(strip, 1.25, -0.8, 0), kOrange);
    EXPECT_EQ(at(strip, 2.8, 0.9, 1), kGrey);
    EXPECT_EQ(strip.at<cv::Vec3b>(40, 143), kWhite) << "the gap between the moments";
}

TEST(Strips, WallThinnerThanAPixelIsVisibleInEveryRow) {
    Recording recording = short_drive();
    recording.scans.resize(2);
    recording.scans[1].ranges.assign(31, kInvalidRange); // without valid readings, so that no points cover the wall
    std::vector<Moment> moments;
    SessionOptions options;
    options.cell_size = 0.01;
    options.obstacle_thickness = 0.01;
    const auto keep = [&](std::size_t scans, mapping::Projection& projection) {
        if (scans == 2) moments.push_back({projection.snapshot(), scans});
    };
    ASSERT_TRUE(integrate_recording(
        recording, options, [] { return 0.0; }, keep));
    const cv::Mat strip = cv::imdecode(strip_png(moments, recording, {-0.5, -1.2, 3.0, 1.0}), cv::IMREAD_COLOR);
    for (double y = -0.3; y < 0.3; y += 0.025) {
        int darkest = 255;
        for (double x = 1.3; x < 1.6; x += 0.025) darkest = std::min<int>(darkest, at(strip, x, y, 0)[0]);
        EXPECT_LT(darkest, 60) << y;
    }
}

INSTANTIATE_TEST_SUITE_P(CellSizes, StripsAt, testing::Values(0.01, 0.05, 0.1));

} // namespace
} // namespace scanloom::lab
