#include "tests/unit/server/http/api_fixture.hpp"

#include "core/classify/frontiers.hpp"
#include "core/planning/coverage.hpp"
#include "core/planning/goals.hpp"
#include "core/planning/grid_path.hpp"

#include <boost/json/array.hpp>
#include <boost/json/serialize.hpp>

#include <array>
#include <cmath>
#include <set>

namespace scanloom::http {
namespace {

/// A wall around the robot at 3 m, with a sector without readings: frontiers are in that sector and behind the wall.
Scan scan_with_a_gap() {
    Scan taken = scan(1);
    taken.ranges.assign(181, 3'000);
    std::fill(taken.ranges.begin() + 100, taken.ranges.begin() + 130, kInvalidRange);
    return taken;
}

constexpr double kX = 0.5; // where the scan was taken
constexpr double kY = 1.25;

class ApiPlanningTest : public ApiTest {
protected:
    ApiPlanningTest() {
        create("a");
        stream("a", "r1", {scan_with_a_gap()});
    }

    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> maps() { return registry_.find("a")->snapshot(); }
    [[nodiscard]] double cell_size() { return maps()->config.cell_size; }

    boost::json::value frontiers(const std::string& query = "") {
        return get_json("/api/v1/sessions/a/frontiers.geojson" + (query.empty() ? "" : "?" + query));
    }

    Response post(const std::string& what, const std::string& body) {
        return ask("POST", "/api/v1/sessions/a/" + what, body);
    }
    boost::json::value post_json(const std::string& what, const std::string& body) {
        const auto response = post(what, body);
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        EXPECT_EQ(response.get("Content-Type"), what.starts_with("goal") ? kJson : kGeoJson);
        return boost::json::parse(response.body.bytes());
    }
    void expect_bad(const std::string& what, const std::string& body, const std::string& beginning) {
        EXPECT_THAT(detail(post(what, body), Status::bad_request), StartsWith(beginning)) << body;
    }
};

double number(const boost::json::value& value) { return value.to_number<double>(); }

std::vector<Point2> points_of(const boost::json::value& line) {
    std::vector<Point2> points;
    for (const auto& point : line.at("coordinates").as_array())
        points.push_back({number(point.at(0)), number(point.at(1))});
    return points;
}

double length_of(const std::vector<Point2>& points) {
    double length = 0.0;
    for (std::size_t n = 0; n + 1 < points.size(); ++n) length += norm(points[n + 1] - points[n]);
    return length;
}

/// Returns the area of a ring; negative for a hole.
double area_of(const boost::json::value& ring) {
    double twice = 0.0;
    const auto& corners = ring.as_array();
    for (std::size_t n = 0; n + 1 < corners.size(); ++n) {
        twice += number(corners[n].at(0)) * number(corners[n + 1].at(1)) -
                 number(corners[n + 1].at(0)) * number(corners[n].at(1));
    }
    return 0.5 * twice;
}

double area_of_polygons(const boost::json::value& geometry) {
    EXPECT_EQ(geometry.at("type"), "MultiPolygon");
    double area = 0.0;
    for (const auto& polygon : geometry.at("coordinates").as_array()) {
        for (const auto& ring : polygon.as_array()) area += area_of(ring);
    }
    return area;
}

// Frontiers

TEST_F(ApiPlanningTest, FrontiersHaveTheirCellsAsPolygons) {
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

TEST_F(ApiPlanningTest, FrontiersHaveTheGoalsOfTheNamedRobot) {
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

TEST_F(ApiPlanningTest, EachFrontierHasTheNearestRobot) {
    Scan elsewhere = scan_with_a_gap();
    elsewhere.pose->x = 2.0;
    stream("a", "r2", {elsewhere});
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

TEST_F(ApiPlanningTest, DistantScanDoesNotChangeThePlan) {
    const std::string to_the_wall = R"({"from":[1.0,1.0],"to":[2.5,0.2]})";
    const std::string unknown = R"({"from":[1.0,1.0],"to":[2.5,0.2],"allow_unknown":true})";
    const auto plan = post_json("plan", to_the_wall).at("geometry");
    const auto plan_over_unknown = post_json("plan", unknown).at("geometry");
    const auto coverage = post_json("coverage", R"({"start":{"robot":"r1"}})").at("features");
    Scan stray = scan_with_a_gap();
    stray.pose = {4500.0, 4500.0, 0.0};
    stream("a", "r2", {stray});
    EXPECT_EQ(post_json("plan", to_the_wall).at("geometry"), plan);
    EXPECT_EQ(post_json("plan", unknown).at("geometry"), plan_over_unknown);
    EXPECT_EQ(post_json("coverage", R"({"start":{"robot":"r1"}})").at("features"), coverage);
    EXPECT_EQ(post_json("goal", R"({"robot":"r1"})").at("outcome"), "goal");
    EXPECT_EQ(post_json("goal", R"({"robot":"r2"})").at("outcome"), "goal");
    EXPECT_EQ(frontiers().at("robots").as_array().size(), 2U);
}

TEST_F(ApiPlanningTest, FrontiersAreListedForAnyBodyRadius) {
    const auto wide = frontiers("body_radius=5").at("features").as_array().size();
    EXPECT_EQ(wide, classify::find_frontiers(maps()->classes).size());
    EXPECT_GT(wide, 1U);
}

TEST_F(ApiPlanningTest, SizeMinLeavesOutSmallFrontiers) {
    const std::size_t largest = classify::find_frontiers(maps()->classes).front().cells.size();
    EXPECT_EQ(frontiers("size_min=" + std::to_string(largest)).at("features").as_array().size(), 1U);
    const auto none = frontiers("size_min=" + std::to_string(largest + 1));
    EXPECT_TRUE(none.at("features").as_array().empty());
    EXPECT_FALSE(none.at("any_reachable").as_bool());
}

TEST_F(ApiPlanningTest, SettingsAreRefused) {
    EXPECT_THAT(detail(get("/api/v1/sessions/a/frontiers.geojson?cell_size=0.1"), Status::bad_request),
                HasSubstr("POST them to .../weave"));
    EXPECT_THAT(detail(post("goal?until=3", R"({"robot":"r1"})"), Status::bad_request),
                HasSubstr("POST them to .../weave"));
}

TEST_F(ApiPlanningTest, FrontiersAreUnreachableWithoutARobotPose) {
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

TEST_F(ApiPlanningTest, InvalidParametersAreNamed) {
    const std::string session = "/api/v1/sessions/a/";
    for (const auto& [target, beginning] : {
             std::pair{"frontiers.geojson?size_min=0", "size_min is \"0\""},
             std::pair{"frontiers.geojson?size_min=-1", "size_min is \"-1\""},
             std::pair{"frontiers.geojson?size_min=many", "size_min is \"many\""},
             std::pair{"frontiers.geojson?body_radius=nan", "body_radius is \"nan\""},
             std::pair{"frontiers.geojson?body_radius=-1", "body_radius is -1 m"},
             std::pair{"frontiers.geojson?colour=red", "the parameter \"colour\" is unknown"},
             std::pair{"goal?robot=r1&colour=red", "the parameter \"colour\" is unknown"},
             std::pair{"goal", "robot is missing"},
         }) {
        EXPECT_THAT(detail(get(session + target), Status::bad_request), StartsWith(beginning));
    }
    for (const char* target : {"frontiers.geojson?robot=r9", "goal?robot=r9"}) {
        EXPECT_THAT(detail(get(session + target), Status::not_found),
                    StartsWith("robot is \"r9\": these maps have no robot"));
    }
    EXPECT_EQ(get("/api/v1/sessions/none/frontiers.geojson").status, Status::not_found);
    EXPECT_EQ(post("goal?weave=0123456789abcdef", R"({"robot":"r1"})").status, Status::not_found);
}

// Plans

TEST_F(ApiPlanningTest, PlanEqualsThePathOfThePlanner) {
    const auto answer = post_json("plan", R"({"from":[1.0,1.0],"to":[2.5,0.2]})");
    const auto expected = planning::plan_path(maps()->classes, cell_size(), {1.0, 1.0}, {2.5, 0.2}).value();
    EXPECT_EQ(answer.at("type"), "Feature");
    EXPECT_EQ(answer.at("revision"), 3);
    EXPECT_EQ(answer.at("geometry").at("type"), "LineString");
    const auto points = points_of(answer.at("geometry"));
    ASSERT_EQ(points.size(), expected.points.size());
    for (std::size_t n = 0; n < points.size(); ++n) EXPECT_LT(norm(points[n] - expected.points[n]), 2e-6);
    EXPECT_NEAR(number(answer.at("properties").at("length")), expected.length_m, 1e-6);
    EXPECT_NEAR(number(answer.at("properties").at("cost")), expected.cost, 1e-6);
}

TEST_F(ApiPlanningTest, PlanStartsAtTheNamedRobot) {
    const auto points = points_of(post_json("plan", R"({"from":{"robot":"r1"},"to":[2.5,0.2]})").at("geometry"));
    EXPECT_EQ(points.front(), (Point2{kX, kY}));
    EXPECT_EQ(points.back(), (Point2{2.5, 0.2}));
}

TEST_F(ApiPlanningTest, BodyRadiusDefaultsToThatOfTheRobot) {
    Scan scan = scan_with_a_gap();
    scan.seq = 2;
    const auto link = join("a", "r1", scan.seq, 0.5); // joins again with a body radius
    registry_.find("a")->submit(link, {scan}, 1);
    link->wait();
    const std::string near_wall = R"({"from":{"robot":"r1"},"to":[3.2,1.25])";
    EXPECT_THAT(detail(post("plan", near_wall + "}"), Status::conflict), HasSubstr("than the body radius of 0.5 m"));
    EXPECT_EQ(post("plan", near_wall + R"(,"body_radius":0.1})").status, Status::ok);
    EXPECT_EQ(post("plan", R"({"from":[1.0,1.0],"to":[3.2,1.25]})").status, Status::ok) << "no robot is named";

    const auto covered = [&](const std::string& body) { return post_json("coverage", body).at("features").at(0); };
    EXPECT_EQ(covered("{}"), covered(R"({"body_radius":0.5})"));
    EXPECT_EQ(covered(R"({"start":{"robot":"r1"}})"), covered(R"({"body_radius":0.5})"));
    EXPECT_NE(covered(R"({"start":[0.5,1.25]})"), covered("{}"));

    const auto goal = [&](const std::string& more) { return post_json("goal", R"({"robot":"r1")" + more + "}"); };
    const auto own = goal("");
    EXPECT_EQ(own, goal(R"(,"body_radius":0.5)"));
    EXPECT_NE(own, goal(R"(,"body_radius":0.15)"));
}

TEST_F(ApiPlanningTest, PlanOptionsAreApplied) {
    const std::string beyond = R"({"from":[1.0,1.0],"to":[-2.5,1.0])";
    EXPECT_THAT(detail(post("plan", beyond + "}"), Status::conflict), HasSubstr("the goal (-2.5, 1) is "));
    const auto around = post_json("plan", beyond + R"(,"allow_unknown":true})");
    EXPECT_EQ(points_of(around.at("geometry")).back(), (Point2{-2.5, 1.0}));
    const auto near_wall = R"({"from":[1.0,1.0],"to":[3.4,1.25],"body_radius":)";
    EXPECT_THAT(detail(post("plan", std::string(near_wall) + "0.5}"), Status::conflict), HasSubstr("body radius"));
    const auto cheap = post_json("plan", std::string(near_wall) + R"(0,"danger_cost":0})");
    const auto dear = post_json("plan", std::string(near_wall) + R"(0,"danger_cost":100})");
    EXPECT_NEAR(number(cheap.at("properties").at("cost")), number(cheap.at("properties").at("length")), 1e-6);
    EXPECT_GT(number(dear.at("properties").at("cost")), number(dear.at("properties").at("length")) + 1.0);
}

TEST_F(ApiPlanningTest, MissingPathHasAReason) {
    join("a", "mute", 1);
    for (const auto& [body, why] : {
             std::pair{R"({"from":[1.0,1.0],"to":[3.53,1.25]})", "inside an obstacle"},
             std::pair{R"({"from":[900,1],"to":[1,1.25]})", "the start (900, 1) is outside the map"},
             std::pair{R"({"from":{"robot":"mute"},"to":[1,1.25]})", "from: the position of robot 'mute' is not known"},
         }) {
        const auto response = post("plan", body);
        EXPECT_THAT(detail(response, Status::conflict), HasSubstr(why));
        EXPECT_EQ(boost::json::parse(response.body.bytes()).at("type"), "urn:scanloom:error:no_path");
    }
}

TEST_F(ApiPlanningTest, InvalidPlanFieldsAreNamed) {
    for (const auto& [body, beginning] : {
             std::pair{R"({})", "from is missing"},
             std::pair{R"({"from":[1,1]})", "to is missing"},
             std::pair{R"({"from":[1,1],"to":null})", "to is not a point"},
             std::pair{R"({"from":[1,1],"to":[1]})", "to is not a point"},
             std::pair{R"({"from":[1,1,1],"to":[1,1]})", "from is not a point"},
             std::pair{R"({"from":[1,"1"],"to":[1,1]})", "from[1] is not a number"},
             std::pair{R"({"from":[1,1],"to":[1e7,1]})", "to[0] is 10000000 m"},
             std::pair{R"({"from":[1,-1e300],"to":[1,1]})", "from[1] is -1e+300 m"},
             std::pair{R"({"from":"r1","to":[1,1]})", "from is neither"},
             std::pair{R"({"from":{"name":"r1"},"to":[1,1]})", "from: the field \"name\" is unknown"},
             std::pair{R"({"from":{},"to":[1,1]})", "from: robot is missing"},
             std::pair{R"({"from":{"robot":7},"to":[1,1]})", "from: robot is not a string"},
             std::pair{R"({"from":[1,1],"to":{"robot":"r1"}})", "to is not a point"},
             std::pair{R"({"from":[1,1],"to":[1,1],"allow_unknown":1})", "allow_unknown is neither"},
             std::pair{R"({"from":[1,1],"to":[1,1],"body_radius":"x"})", "body_radius is not a number"},
             std::pair{R"({"from":[1,1],"to":[1,1],"body_radius":-0.1})", "body_radius is -0.1 m"},
             std::pair{R"({"from":[1,1],"to":[1,1],"danger_cost":1001})", "danger_cost is 1001"},
             std::pair{R"({"from":[1,1],"to":[1,1],"danger_cost":1e999})", ""},
             std::pair{R"({"from":[1,1],"to":[1,1],"via":[1,1]})", "the field \"via\" is unknown"},
             std::pair{R"([1,1])", "the body is JSON but not an object"},
             std::pair{R"({"from":[NaN,1],"to":[1,1]})", "the body is not JSON"},
         }) {
        expect_bad("plan", body, beginning);
    }
    EXPECT_THAT(detail(post("plan", R"({"from":{"robot":"r9"},"to":[1,1]})"), Status::not_found),
                StartsWith("from is robot \"r9\": these maps have no robot"));
    EXPECT_THAT(detail(post("plan?speed=9", R"({"from":[1,1],"to":[1,1]})"), Status::bad_request),
                StartsWith("the parameter \"speed\" is unknown"));
}

// Coverage

TEST_F(ApiPlanningTest, CoverageHasThePathAndTheUnreachableArea) {
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

TEST_F(ApiPlanningTest, RegionIsAPolygonOrABox) {
    const std::string start = R"({"start":[1.0,1.0],"region":)";
    const auto box = post_json("coverage", start + "[1,0.5,2,1.5]}");
    const auto polygon = post_json("coverage", start + "[[1,0.5],[2,0.5],[2,1.5],[1,1.5]]}");
    EXPECT_EQ(box, polygon);
    EXPECT_NEAR(number(box.at("features").at(0).at("properties").at("free_area")), 1.0, 0.1);
    const auto triangle = post_json("coverage", start + "[[1,0.5],[2,0.5],[2,1.5]]}");
    EXPECT_NEAR(number(triangle.at("features").at(0).at("properties").at("free_area")), 0.5, 0.1);
}

TEST_F(ApiPlanningTest, StartDefaultsToTheOnlyRobot) {
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

TEST_F(ApiPlanningTest, InvalidCoverageFieldsAreNamed) {
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

// Goals

TEST_F(ApiPlanningTest, GoalIsTheFrontierWithTheCheapestPath) {
    const auto answer = post_json("goal", R"({"robot":"r1"})");
    const auto expected = planning::next_goal(maps()->classes, cell_size(), {kX, kY}).value();
    ASSERT_EQ(answer.at("outcome"), "goal");
    const auto points = points_of(answer.at("path"));
    EXPECT_EQ(points.front(), (Point2{kX, kY}));
    EXPECT_EQ(points.back(), (Point2{number(answer.at("goal").at("x")), number(answer.at("goal").at("y"))}));
    EXPECT_LT(norm(points.back() - expected.path.points.back()), 2e-6);
    EXPECT_NEAR(number(answer.at("target").at("x")), (expected.goal->target.i + 0.5) * 0.05, 1e-6);
    EXPECT_NEAR(number(answer.at("target").at("y")), (expected.goal->target.j + 0.5) * 0.05, 1e-6);
    EXPECT_NEAR(number(answer.at("length")), expected.path.length_m, 1e-6);
    EXPECT_EQ(post_json("goal", R"({"robot":"r1"})"), answer) << "a new request releases the previous goal";
}

/// Returns the index of the frontier that contains the target of a response.
std::size_t frontier_of(const boost::json::value& answer, const std::vector<classify::Frontier>& frontiers) {
    const auto cell_of = [](const boost::json::value& metres) {
        return static_cast<std::int32_t>(std::floor(number(metres) / 0.05));
    };
    const grid::Cell target{cell_of(answer.at("target").at("x")), cell_of(answer.at("target").at("y"))};
    const auto found = std::ranges::find_if(
        frontiers, [&](const auto& one) { return std::ranges::find(one.cells, target) != one.cells.end(); });
    return static_cast<std::size_t>(found - frontiers.begin());
}

TEST_F(ApiPlanningTest, TwoRobotsGetDifferentFrontiersUntilNoneIsLeft) {
    std::set<std::size_t> given;
    std::string outcome = "goal";
    for (int n = 0; outcome == "goal"; ++n) {
        const auto robot = "robot-" + std::to_string(n);
        stream("a", robot, {scan_with_a_gap()});
        const auto answer = post_json("goal", fmt::format(R"({{"robot":"{}","size_min":10}})", robot));
        outcome = answer.at("outcome").as_string();
        if (outcome != "goal") break;
        const auto frontiers = classify::find_frontiers(maps()->classes, 10);
        const auto frontier = frontier_of(answer, frontiers);
        ASSERT_LT(frontier, frontiers.size());
        ASSERT_TRUE(given.insert(frontier).second) << robot << " got the frontier of another";
    }
    EXPECT_EQ(outcome, "taken_by_others");
    EXPECT_GE(given.size(), 2U);
}

TEST_F(ApiPlanningTest, UnobservableFrontierCellsAreGivenUp) {
    const auto answer = post_json("goal", R"({"robot":"r1"})");
    EXPECT_EQ(answer.at("given_up"), 0);
    Scan blind = scan_with_a_gap();
    blind.pose->x = number(answer.at("goal").at("x"));
    blind.pose->y = number(answer.at("goal").at("y"));
    blind.pose->yaw = std::atan2(number(answer.at("target").at("y")) - blind.pose->y,
                                 number(answer.at("target").at("x")) - blind.pose->x);
    std::ranges::fill(blind.ranges, kInvalidRange);
    blind.seq = 2;
    stream("a", "r1", {blind});
    const auto next = post_json("goal", R"({"robot":"r1"})");
    EXPECT_GT(next.at("given_up").to_number<int>(), 0);
    EXPECT_NE(next.at("target"), answer.at("target"));
}

TEST_F(ApiPlanningTest, RobotWithoutPoseHasNoGoal) {
    join("a", "mute", 1);
    EXPECT_THAT(detail(post("goal", R"({"robot":"mute"})"), Status::conflict), HasSubstr("has sent no scan yet"));
}

TEST_F(ApiPlanningTest, InvalidGoalRequestsAreRefused) {
    for (const auto& [body, beginning] : {
             std::pair{"{}", "robot is missing"},
             std::pair{R"({"robot":1})", "robot is "},
             std::pair{R"({"robot":"r1","size_min":0})", "size_min is no whole number of cells"},
             std::pair{R"({"robot":"r1","size_min":1.5})", "size_min is no whole number of cells"},
             std::pair{R"({"robot":"r1","body_radius":7})", "body_radius is 7 m"},
             std::pair{R"({"robot":"r1","until":3})", "the field \"until\" is unknown"},
         }) {
        expect_bad("goal", body, beginning);
    }
    EXPECT_THAT(detail(post("goal", R"({"robot":"none"})"), Status::not_found), HasSubstr(R"(robot is "none")"));
}

// All

TEST_F(ApiPlanningTest, PlansOnAReplayJobLikeOnTheSession) {
    const auto started = ask("POST", "/api/v1/sessions/a/weave", R"({"cell_size":0.1})");
    const std::string id(boost::json::parse(started.body.bytes()).at("id").as_string());
    finish_weave("a", id);
    const auto weave = "weave=" + id;
    EXPECT_NEAR(number(frontiers(weave).at("features").at(0).at("properties").at("area")) /
                    number(frontiers(weave).at("features").at(0).at("properties").at("cells")),
                0.01, 1e-9);
    const auto plan = post_json("plan?" + weave, R"({"from":[1.0,1.0],"to":[2.5,0.2]})");
    EXPECT_EQ(points_of(plan.at("geometry")).back(), (Point2{2.5, 0.2}));
    post_json("coverage?" + weave, "{}");
    EXPECT_EQ(post_json("goal?" + weave, R"({"robot":"r1"})").at("outcome"), "goal");
}

TEST_F(ApiPlanningTest, SearchIsRefusedDuringShutdown) {
    registry_.drain();
    EXPECT_THAT(detail(post("plan", R"({"from":[1.0,1.0],"to":[2.5,0.2]})"), Status::service_unavailable),
                HasSubstr("shutting down"));
    EXPECT_EQ(get("/api/v1/sessions/a/frontiers.geojson").status, Status::service_unavailable);
}

} // namespace
} // namespace scanloom::http
