#include "tests/unit/server/http/api_planning_fixture.hpp"

#include "core/classify/frontiers.hpp"
#include "core/planning/goals.hpp"

#include <boost/json/array.hpp>
#include <boost/json/serialize.hpp>

#include <array>
#include <set>

namespace scanloom::http {
namespace {

class ApiFrontiersTest : public ApiPlanningTest {};

TEST_F(ApiFrontiersTest, FrontiersHaveTheirCellsAsPolygons) {
    const auto answer = frontiers();
    const auto expected = classify::find_frontiers(maps()->classes);
    const auto& features = answer.at("features").as_array();
    ASSERT_EQ(features.size(), expected.size());
    EXPECT_EQ(answer.at("revision"), 3);
    for (std::size_t n = 0; n < expected.size(); ++n) {
        const auto& properties = features[n].at("properties");
        const double size = static_cast<double>(expected[n].cells.size());
        EXPECT_EQ(number(properties.at("cells")), size);
        EXPECT_NEAR(number(properties.at("area")), size * 0.0025, 1e-6);
        EXPECT_NEAR(number(properties.at("centroid").at(0)), expected[n].centroid_x * 0.05, 1e-6);
        EXPECT_NEAR(number(properties.at("centroid").at(1)), expected[n].centroid_y * 0.05, 1e-6);
        EXPECT_NEAR(area_of_polygons(features[n].at("geometry")), size * 0.0025, 1e-6);
    }
}

TEST_F(ApiFrontiersTest, FrontiersHaveTheGoalsOfTheNamedRobot) {
    const auto found = classify::find_frontiers(maps()->classes);
    const auto goals = planning::frontier_goals(maps()->classes, cell_size(), found, {kX, kY}).value();
    for (const char* query : {"", "robot=r1"}) {
        const auto answer = frontiers(query);
        EXPECT_EQ(boost::json::serialize(answer.at("robots")), R"(["r1"])");
        EXPECT_TRUE(answer.at("any_reachable").as_bool());
        for (std::size_t n = 0; n < found.size(); ++n) {
            const auto& properties = answer.at("features").at(n).at("properties");
            ASSERT_EQ(properties.at("reachable").as_bool(), goals[n].has_value());
            ASSERT_EQ(properties.at("goal").is_null(), !goals[n]);
            if (!goals[n]) continue;
            EXPECT_EQ(properties.at("robot"), "r1");
            EXPECT_EQ(properties.at("in_danger").as_bool(), goals[n]->in_danger);
            EXPECT_NEAR(number(properties.at("goal").at(0)), (goals[n]->cell.i + 0.5) * 0.05, 1e-6);
            EXPECT_NEAR(number(properties.at("goal").at(1)), (goals[n]->cell.j + 0.5) * 0.05, 1e-6);
            EXPECT_NEAR(number(properties.at("length")), goals[n]->length_m, 1e-6);
            EXPECT_NEAR(number(properties.at("cost")), goals[n]->cost, 1e-6);
        }
    }
}

TEST_F(ApiFrontiersTest, EachFrontierHasTheNearestRobot) {
    stream("a", "r2", {scan_with_a_gap(2.0)});
    const auto all = frontiers();
    const std::array alone = {frontiers("robot=r1"), frontiers("robot=r2")};
    std::set<std::string> robots;
    for (const auto& feature : all.at("features").as_array()) {
        const auto& best = feature.at("properties");
        if (best.at("goal").is_null()) continue;
        robots.insert(std::string(best.at("robot").as_string()));
        for (const auto& one : alone) {
            for (const auto& other : one.at("features").as_array()) {
                if (other.at("properties").at("centroid") != best.at("centroid")) continue;
                if (other.at("properties").at("goal").is_null()) continue;
                EXPECT_LE(number(best.at("cost")), number(other.at("properties").at("cost")));
            }
        }
    }
    EXPECT_EQ(robots, (std::set<std::string>{"r1", "r2"}));
}

TEST_F(ApiFrontiersTest, FrontiersAreListedForAnyBodyRadius) {
    const auto wide = frontiers("body_radius=5").at("features").as_array().size();
    EXPECT_EQ(wide, classify::find_frontiers(maps()->classes).size());
    EXPECT_GT(wide, 1U);
}

TEST_F(ApiFrontiersTest, SizeMinLeavesOutSmallFrontiers) {
    const std::size_t largest = classify::find_frontiers(maps()->classes).front().cells.size();
    EXPECT_EQ(frontiers("size_min=" + std::to_string(largest)).at("features").as_array().size(), 1U);
    const auto none = frontiers("size_min=" + std::to_string(largest + 1));
    EXPECT_TRUE(none.at("features").as_array().empty());
    EXPECT_FALSE(none.at("any_reachable").as_bool());
}

TEST_F(ApiFrontiersTest, SettingsAreRefused) {
    EXPECT_THAT(detail(get("/api/v1/sessions/a/frontiers.geojson?cell_size=0.1"), Status::bad_request),
                HasSubstr("POST them to .../weave"));
}

TEST_F(ApiFrontiersTest, FrontiersAreUnreachableWithoutARobotPose) {
    create("b");
    const auto empty = get_json("/api/v1/sessions/b/frontiers.geojson");
    EXPECT_FALSE(empty.at("any_reachable").as_bool());
    EXPECT_TRUE(empty.at("features").as_array().empty());
    join("a", "mute", 1);
    const auto of_mute = frontiers("robot=mute");
    EXPECT_TRUE(of_mute.at("robots").as_array().empty());
    EXPECT_FALSE(of_mute.at("any_reachable").as_bool());
    ASSERT_FALSE(of_mute.at("features").as_array().empty());
    EXPECT_TRUE(of_mute.at("features").at(0).at("properties").at("goal").is_null());
    EXPECT_EQ(boost::json::serialize(frontiers().at("robots")), R"(["r1"])") << "the robot without scans is left out";
}

TEST_F(ApiFrontiersTest, InvalidParametersAreNamed) {
    const std::string session = "/api/v1/sessions/a/";
    for (const auto& [target, beginning] : {
             std::pair{"frontiers.geojson?size_min=0", "size_min is \"0\""},
             std::pair{"frontiers.geojson?size_min=-1", "size_min is \"-1\""},
             std::pair{"frontiers.geojson?size_min=many", "size_min is \"many\""},
             std::pair{"frontiers.geojson?body_radius=nan", "body_radius is \"nan\""},
             std::pair{"frontiers.geojson?body_radius=-1", "body_radius is -1 m"},
             std::pair{"frontiers.geojson?colour=red", "the parameter \"colour\" is unknown"},
         }) {
        EXPECT_THAT(detail(get(session + target), Status::bad_request), StartsWith(beginning));
    }
    EXPECT_THAT(detail(get(session + "frontiers.geojson?robot=r9"), Status::not_found),
                StartsWith("robot is \"r9\": these maps have no robot"));
    EXPECT_EQ(get("/api/v1/sessions/none/frontiers.geojson").status, Status::not_found);
}

} // namespace
} // namespace scanloom::http
