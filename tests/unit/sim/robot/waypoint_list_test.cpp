#include "sim/robot/waypoint_list.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace scanloom::sim {
namespace {

using testing::HasSubstr;

class WaypointList : public testing::Test {
protected:
    std::string file(const std::string& content) {
        const auto path = directory_.path() / "waypoints.txt";
        std::ofstream(path) << content;
        return path.string();
    }

    TemporaryDirectory directory_;
};

TEST_F(WaypointList, IsReadFromOneLine) {
    const auto waypoints = read_waypoints("1,2.5; -3 , +4;1e1 0;");
    ASSERT_TRUE(waypoints);
    EXPECT_EQ(*waypoints, (std::vector<Point2>{{1.0, 2.5}, {-3.0, 4.0}, {10.0, 0.0}}));
    EXPECT_EQ(to_text(*waypoints), "1,2.5;-3,4;10,0");
}

TEST_F(WaypointList, IsReadFromAFile) {
    const auto waypoints = read_waypoints(file("# a tour\n1 2.5\r\n\n-3,4 # there\n"));
    ASSERT_TRUE(waypoints);
    EXPECT_EQ(*waypoints, (std::vector<Point2>{{1.0, 2.5}, {-3.0, 4.0}}));
}

TEST_F(WaypointList, ErrorsNameTheirPosition) {
    EXPECT_THAT(read_waypoints("1,2;3;4,5").error().message, HasSubstr("number 2: '3'"));
    EXPECT_THAT(read_waypoints("1,2;;4,5").error().message, HasSubstr("number 2: ''"));
    EXPECT_THAT(read_waypoints("1,2,3").error().message, HasSubstr("number 1"));
    EXPECT_THAT(read_waypoints("1,2e9").error().message, HasSubstr("1000000 from the origin"));
    EXPECT_THAT(read_waypoints(file("1 2\nhere\n")).error().message, HasSubstr("line 2: 'here'"));
    EXPECT_THAT(read_waypoints(file("nan 1\n")).error().message, HasSubstr("line 1"));
}

TEST_F(WaypointList, HasOneToTenThousandWaypoints) {
    EXPECT_THAT(read_waypoints(";").error().message, HasSubstr("the list is empty"));
    EXPECT_THAT(read_waypoints(file("# none\n")).error().message, HasSubstr("the list is empty"));
    std::string many;
    for (int n = 0; n < 10'001; ++n) many += "1 1\n";
    EXPECT_THAT(read_waypoints(file(many)).error().message, HasSubstr("more than 10000"));
    many.resize(many.size() - 4);
    EXPECT_EQ(read_waypoints(file(many))->size(), 10'000U);
}

TEST_F(WaypointList, MissingFileIsNotFound) {
    const auto waypoints = read_waypoints("/nonexistent/tour.txt");
    ASSERT_FALSE(waypoints);
    EXPECT_EQ(waypoints.error().code, Errc::kNotFound);
    EXPECT_THAT(waypoints.error().message, HasSubstr("neither a list"));
}

} // namespace
} // namespace scanloom::sim
