#include "lab/cloud_pictures.hpp"

#include "tests/unit/lab/drawn_clouds.hpp"

#include <opencv2/imgcodecs.hpp>

#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

const cv::Vec3b kPanelBlue(190, 95, 0);
const cv::Vec3b kPanelOrange(0, 120, 235);
const cv::Vec3b kPale(200, 200, 200);
const cv::Vec3b kPanelRed(40, 30, 210);
const cv::Vec3b kBlack(0, 0, 0);
const cv::Vec3b kPanelWhite(255, 255, 255);

/// Two bars at x = 0 and x = 4 in the first capture. In the second capture the right bar is 2 m higher. The lidar is at
/// (2, -2). The picture has a margin of 0.3 m and halves of 600 pixels: x from -0.5 to 4.5 (120 pixels per metre), y
/// from 2.3 to -2.3.
class LandmarkPicture : public testing::Test {
protected:
    LandmarkPicture() {
        const auto comparison = compare(first_, second_).value();
        picture_ = cv::imdecode(comparison_png(first_, second_, comparison.matches, {2.0, -2.0}), cv::IMREAD_COLOR);
    }

    [[nodiscard]] cv::Vec3b at(double x, double y, int panel) const {
        return picture_.at<cv::Vec3b>(static_cast<int>((2.3 - y) * 120.0),
                                      static_cast<int>((x + 0.5) * 120.0) + panel * 612);
    }

    const SeenLandmarks first_ = seen_bars({{0.0, 0.0}, {4.0, 0.0}});
    const SeenLandmarks second_ = seen_bars({{0.0, 0.0}, {4.0, 2.0}});
    cv::Mat picture_;
};

TEST_F(LandmarkPicture, ShowsTheFirstCaptureLeftAndTheSecondRight) {
    ASSERT_EQ(picture_.cols, 600 + 12 + 600);
    ASSERT_EQ(picture_.rows, 552);
    EXPECT_EQ(at(-0.1195, -0.004, 0), kPanelBlue);
    EXPECT_EQ(at(-0.1195, -0.004, 1), kPanelOrange);
    EXPECT_EQ(at(3.8805, -0.004, 0), kPanelBlue);
    EXPECT_EQ(at(3.8805, -0.004, 1), kPale) << "points of the other capture only";
    EXPECT_EQ(at(3.8805, 1.996, 0), kPale);
    EXPECT_EQ(at(3.8805, 1.996, 1), kPanelOrange);
    EXPECT_EQ(at(2.0, 1.0, 0), kPanelWhite);
}

TEST_F(LandmarkPicture, MarksUnmatchedLandmarksAndTheLidar) {
    EXPECT_EQ(at(0.0, 0.0, 0), kPanelBlue);
    EXPECT_EQ(at(0.0, 0.0, 1), kPanelOrange);
    EXPECT_EQ(at(4.0, 7.0 / 120.0, 0), kPanelRed);
    EXPECT_EQ(at(4.0, 2.0 + 7.0 / 120.0, 1), kPanelRed);
    for (const int panel : {0, 1}) EXPECT_EQ(at(2.0, -2.0, panel), kBlack);
}

TEST_F(LandmarkPicture, ConnectsMatchesByDashedLines) {
    int dark = 0;
    int light = 0;
    int changes = 0;
    bool was_dark = false;
    for (int column = 100; column < 500; ++column) {
        const bool is_dark = picture_.at<cv::Vec3b>(276, column)[0] < 200;
        ++(is_dark ? dark : light);
        changes += is_dark != was_dark;
        was_dark = is_dark;
    }
    EXPECT_GT(dark, 100);
    EXPECT_GT(light, 100);
    EXPECT_GT(changes, 20);
    for (int column = 100; column < 500; ++column) {
        EXPECT_EQ(picture_.at<cv::Vec3b>(200, column), kPanelWhite) << "no other lines, column " << column;
    }
}

TEST(LandmarkPictures, EmptyCapturesShowTheLidar) {
    const auto none = seen_bars({});
    const auto picture = cv::imdecode(comparison_png(none, none, {}, {1.0, 1.0}), cv::IMREAD_COLOR);
    EXPECT_EQ(picture.cols, 1212);
    EXPECT_EQ(picture.at<cv::Vec3b>(300, 300), kBlack);
}

} // namespace
} // namespace scanloom::lab
