#include "server/landmarks/point_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace scanloom::landmarks {
namespace {

using testing::HasSubstr;

TEST(PointCheck, AcceptsFinitePointsWithinTheLimit) {
    EXPECT_TRUE(check_points({}));
    EXPECT_TRUE(check_points(std::vector<Point2>{{0.0, -0.0}, {1e7, -1e7}, {1e-300, 5e-324}}));
}

TEST(PointCheck, RefusesTheFirstPointThatIsNotFinite) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
        for (const Point2& point : {Point2{bad, 0.0}, Point2{0.0, bad}}) {
            const auto checked = check_points(std::vector<Point2>{{1.0, 2.0}, point, point});
            ASSERT_FALSE(checked);
            EXPECT_EQ(checked.error().code, Errc::kInvalidField);
            EXPECT_THAT(checked.error().message, HasSubstr("points[1]"));
        }
    }
}

TEST(PointCheck, RefusesTheFirstPointThatIsTooFar) {
    const auto checked = check_points(std::vector<Point2>{{1.0, 2.0}, {0.0, -1.1e7}});
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, Errc::kInvalidField);
    EXPECT_THAT(checked.error().message, HasSubstr("points[1] is (0, -11000000)"));
}

} // namespace
} // namespace scanloom::landmarks
