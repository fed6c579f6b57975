#include "lab/cloud_pictures.hpp"

#include <opencv2/imgcodecs.hpp>

#include <gtest/gtest.h>

#include <numbers>

namespace scanloom::lab {
namespace {

/// A map of two points at (0, 0) and (8.4, 4.4), observed from (2, 1) and (6, 1). A robot at (4, 3) that heads north
/// has one point 1 m ahead and one 2 m to its right. With a margin of 0.3 m, 100 pixels are 1 m.
class LocatedPicture : public testing::Test {
protected:
    LocatedPicture() {
        const robot::MappedWorld scene{.map = {{{2.0, 1.0}, {{0, 0}}}, {{6.0, 1.0}, {{8400, 4400}}}},
                                       .seen = {{1.0, 0.0}, {0.0, -2.0}},
                                       .truth = {}};
        picture_ = cv::imdecode(located_png(scene, {4.0, 3.0, std::numbers::pi / 2.0}), cv::IMREAD_COLOR);
    }

    [[nodiscard]] cv::Vec3b at(double x, double y) const {
        return picture_.at<cv::Vec3b>(static_cast<int>((4.7 - y) * 100.0 + 0.5),
                                      static_cast<int>((x + 0.3) * 100.0 + 0.5));
    }

    cv::Mat picture_;
};

const cv::Vec3b kMapBlue(190, 95, 0);
const cv::Vec3b kViewOrange(0, 120, 235);

TEST_F(LocatedPicture, ShowsTheMapAndTheViewAtItsLocatedPose) {
    EXPECT_EQ(picture_.cols, 900);
    EXPECT_EQ(at(0.0, 0.0), kMapBlue);
    EXPECT_EQ(at(8.4, 4.4), kMapBlue);
    EXPECT_EQ(at(4.0, 4.0), kViewOrange) << "ahead of the robot";
    EXPECT_EQ(at(6.0, 3.0), kViewOrange) << "to the right of the robot";
    EXPECT_EQ(at(3.0, 2.0), cv::Vec3b(255, 255, 255));
}

TEST_F(LocatedPicture, MarksTheMapsViewpointsAndTheSensor) {
    EXPECT_EQ(at(2.0, 1.0), kMapBlue);
    EXPECT_EQ(at(6.03, 1.0), kMapBlue) << "a disc, not a single point";
    EXPECT_EQ(at(4.0, 3.0), cv::Vec3b(0, 0, 0));
    EXPECT_EQ(at(4.1, 3.0), cv::Vec3b(0, 0, 0)) << "an arm of the cross";
}

} // namespace
} // namespace scanloom::lab
