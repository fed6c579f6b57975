#include "tests/unit/server/http/api_planning_fixture.hpp"

#include "core/planning/grid_path.hpp"

#include <boost/json/array.hpp>

namespace scanloom::http {
namespace {

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
