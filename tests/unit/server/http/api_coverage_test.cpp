#include "tests/unit/server/http/api_planning_fixture.hpp"

#include "core/planning/coverage.hpp"

#include <boost/json/array.hpp>

namespace scanloom::http {
namespace {

class ApiCoverageTest : public ApiPlanningTest {};

double length_of(const std::vector<Point2>& points) {
    double length = 0.0;
    for (std::size_t n = 0; n + 1 < points.size(); ++n) length += norm(points[n + 1] - points[n]);
    return length;
}

TEST_F(ApiCoverageTest, CoverageHasThePathAndTheUnreachableArea) {
    const auto answer = post_json("coverage", R"({"spacing":0.3,"body_radius":0.2})");
    planning::CoverageOptions options;
    options.spacing_m = 0.3;
    options.passability.body_radius_m = 0.2;
    options.passability.on_known = true;
    const auto expected = planning::plan_coverage(maps()->classes, cell_size(), {kX, kY}, options).value();
    const auto& path = answer.at("features").at(0);
    const auto points = points_of(path.at("geometry"));
    EXPECT_EQ(points.size(), expected.path.points.size());
    EXPECT_NEAR(length_of(points), number(path.at("properties").at("length")), 1e-3);
    EXPECT_NEAR(number(path.at("properties").at("length")), expected.path.length_m, 1e-6);
    EXPECT_EQ(number(path.at("properties").at("fraction")), expected.fraction);
    EXPECT_GT(expected.fraction, 0.5);
    const auto covered = number(path.at("properties").at("covered_area"));
    const auto unreachable = number(path.at("properties").at("unreachable_area"));
    EXPECT_NEAR(covered, static_cast<double>(expected.covered_cells) * 0.0025, 1e-6);
    EXPECT_NEAR(covered + unreachable, number(path.at("properties").at("free_area")), 1e-6);
    EXPECT_GT(unreachable, 0.0);
    EXPECT_NEAR(area_of_polygons(answer.at("features").at(1).at("geometry")), unreachable, 1e-6);
}

TEST_F(ApiCoverageTest, RegionIsAPolygonOrABox) {
    const std::string start = R"({"start":[1.0,1.0],"region":)";
    const auto box = post_json("coverage", start + "[1,0.5,2,1.5]}");
    const auto polygon = post_json("coverage", start + "[[1,0.5],[2,0.5],[2,1.5],[1,1.5]]}");
    EXPECT_EQ(box, polygon);
    EXPECT_NEAR(number(box.at("features").at(0).at("properties").at("free_area")), 1.0, 0.1);
    const auto triangle = post_json("coverage", start + "[[1,0.5],[2,0.5],[2,1.5]]}");
    EXPECT_NEAR(number(triangle.at("features").at(0).at("properties").at("free_area")), 0.5, 0.1);
}

TEST_F(ApiCoverageTest, StartDefaultsToTheOnlyRobot) {
    EXPECT_EQ(points_of(post_json("coverage", "{}").at("features").at(0).at("geometry")).front(), (Point2{kX, kY}));
    stream("a", "r2", {scan_with_a_gap()});
    expect_bad("coverage", "{}", "start is missing, and the session has 2 robots");
    post_json("coverage", R"({"start":{"robot":"r2"}})");
    create("b");
    EXPECT_THAT(detail(ask("POST", "/api/v1/sessions/b/coverage", "{}"), Status::bad_request),
                StartsWith("start is missing, and the session has 0 robots"));
    join("b", "mute", 1);
    EXPECT_THAT(detail(ask("POST", "/api/v1/sessions/b/coverage", "{}"), Status::conflict), HasSubstr("'mute'"));
}

TEST_F(ApiCoverageTest, InvalidCoverageFieldsAreNamed) {
    std::string corners = "[0,0]";
    for (int n = 0; n < 4096; ++n) corners += ",[1,1]";
    const auto too_many = R"({"region":[)" + corners + "]}";
    for (const auto& [body, beginning] : {
             std::pair{R"({"start":[1]})", "start is not a point"},
             std::pair{R"({"start":7})", "start is neither"},
             std::pair{R"({"spacing":"wide"})", "spacing is not a number"},
             std::pair{R"({"spacing":9})", "spacing is 9 m"},
             std::pair{R"({"spacing":-1})", "spacing is -1 m"},
             std::pair{R"({"region":{}})", "region is neither a polygon"},
             std::pair{R"({"region":[]})", "region has 0 corners"},
             std::pair{R"({"region":[1,2,3]})", "region[0] is not a point"},
             std::pair{R"({"region":[[0,0],[1,1]]})", "region has 2 corners"},
             std::pair{R"({"region":[[0,0],[1,1],[1,"0"]]})", "region[2][1] is not a number"},
             std::pair{R"({"region":[0,0,"1",1]})", "region[2] is not a number"},
             std::pair{R"({"region":[1,0,0,1]})", "region is an empty box"},
             std::pair{too_many.c_str(), "region has 4097 corners"},
             std::pair{R"({"body_radius":7})", "body_radius is 7 m"},
             std::pair{R"({"allow_unknown":true})", "the field \"allow_unknown\" is unknown"},
         }) {
        expect_bad("coverage", body, beginning);
    }
    EXPECT_THAT(detail(post("coverage", R"({"region":[50,50,51,51]})"), Status::conflict), HasSubstr("region"));
}

} // namespace
} // namespace scanloom::http
