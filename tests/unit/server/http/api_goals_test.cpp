#include "tests/unit/server/http/api_planning_fixture.hpp"

#include "core/classify/frontiers.hpp"
#include "core/planning/goals.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <string>

namespace scanloom::http {
namespace {

using testing::IsEmpty;

class ApiGoalsTest : public ApiPlanningTest {
protected:
    [[nodiscard]] std::string text() { return std::string(get(kTarget).body.bytes()); }
    boost::json::value goals() { return get_json(kTarget); }
    boost::json::value ask_for_goal(const std::string& robot, int size_min = 3) {
        const auto answer =
            ask("POST", "/api/v1/sessions/a/goal", fmt::format(R"({{"robot":"{}","size_min":{}}})", robot, size_min));
        EXPECT_EQ(answer.status, Status::ok);
        return boost::json::parse(answer.body.bytes());
    }
    boost::json::value goal_of(const std::string& robot) { return get_json("/api/v1/sessions/a/goal?robot=" + robot); }
    boost::json::array features() { return goals().at("features").as_array(); }

    /// Disconnects the robot of a link; returns when the session has processed it.
    void leave(RobotIndex robot) {
        const auto session = registry_.find("a");
        session->leave(links_.at(robot));
        join("a", "last", 1); // after it
        EXPECT_FALSE(session->is_connected(robot));
    }

    /// Returns the index of the frontier that contains the target of a response.
    static std::size_t frontier_of(const boost::json::value& answer, const std::vector<classify::Frontier>& frontiers) {
        const auto cell_of = [](const boost::json::value& metres) {
            return static_cast<std::int32_t>(std::floor(number(metres) / 0.05));
        };
        const grid::Cell target{cell_of(answer.at("target").at("x")), cell_of(answer.at("target").at("y"))};
        const auto found = std::ranges::find_if(
            frontiers, [&](const auto& one) { return std::ranges::find(one.cells, target) != one.cells.end(); });
        return static_cast<std::size_t>(found - frontiers.begin());
    }

    static constexpr const char* kTarget = "/api/v1/sessions/a/goals.geojson";
};

// Reading them

TEST_F(ApiGoalsTest, WithoutGoalsTheCollectionIsEmpty) {
    const auto answer = get(kTarget);
    EXPECT_EQ(answer.status, Status::ok);
    EXPECT_EQ(answer.get("Content-Type"), kGeoJson);
    EXPECT_EQ(answer.get("Cache-Control"), kNotKept);
    EXPECT_EQ(text(),
              R"({"type":"FeatureCollection","frame_id":"map","units":"m","revision":0,"explored":[],"features":[]})");
}

TEST_F(ApiGoalsTest, PathsAndGoalsEqualTheAssignedOnes) {
    const auto session = registry_.find("a");
    goals_.paths().give_goal(session, 0, {{1.025, 0.5}, {1.5, 0.75}, true, 3},
                             {guidance::PathKind::kGoal, {{0.5, 1.25}, {1.025, 0.5}}, 0.915492, 3},
                             guidance::RobotPaths::Clock::now());
    EXPECT_EQ(
        text(),
        R"({"type":"FeatureCollection","frame_id":"map","units":"m","revision":1,"explored":[],"features":[)"
        R"({"type":"Feature","properties":{"role":"way","robot":"r1","kind":"goal","length":0.915492,)"
        R"("points_left_out":0,"revision":3},"geometry":{"type":"LineString","coordinates":[[0.5,1.25],[1.025,0.5]]}},)"
        R"({"type":"Feature","properties":{"role":"goal","robot":"r1","target":[1.5,0.75],"in_danger":true,)"
        R"("revision":3},"geometry":{"type":"Point","coordinates":[1.025,0.5]}}]})");
    goals_.paths().set_path(session, 0, guidance::HeldPath{guidance::PathKind::kPlan, {{0.5, 1.25}}, 0.0, 3, 9},
                            guidance::RobotPaths::Clock::now());
    const auto path = features().at(0);
    EXPECT_EQ(path.at("properties").at("kind"), "plan");
    EXPECT_EQ(path.at("properties").at("points_left_out"), 9);
    EXPECT_EQ(path.at("geometry").at("coordinates").as_array().size(), 2U) << "a LineString has at least two positions";
    goals_.paths().set_path(session, 0,
                            guidance::HeldPath{guidance::PathKind::kCoverage, {{0.5, 1.25}, {0.5, 1.5}}, 0.25, 3},
                            guidance::RobotPaths::Clock::now());
    EXPECT_EQ(features().at(0).at("properties").at("kind"), "coverage");
    EXPECT_EQ(features().at(1).at("properties").at("role"), "goal");
}

TEST_F(ApiGoalsTest, GoalsOfTwoRobotsEqualTheirReplies) {
    stream("a", "r2", {scan_with_a_gap(2.0)});
    const std::array answers = {ask_for_goal("r1"), ask_for_goal("r2")};
    const auto shown = features();
    ASSERT_EQ(shown.size(), 4U);
    for (std::size_t n = 0; n < 2; ++n) {
        const auto& answer = answers[n];
        const auto& path = shown[2 * n];
        const auto& goal = shown[2 * n + 1];
        EXPECT_EQ(path.at("properties").at("robot"), answer.at("robot"));
        EXPECT_EQ(goal.at("properties").at("robot"), answer.at("robot"));
        EXPECT_EQ(path.at("geometry"), answer.at("path"));
        EXPECT_EQ(path.at("properties").at("length"), answer.at("length"));
        EXPECT_EQ(path.at("properties").at("revision"), answer.at("revision"));
        EXPECT_EQ(goal.at("properties").at("revision"), answer.at("revision"));
        EXPECT_EQ(goal.at("properties").at("in_danger"), answer.at("in_danger"));
        EXPECT_EQ(goal.at("geometry").at("coordinates").at(0), answer.at("goal").at("x"));
        EXPECT_EQ(goal.at("geometry").at("coordinates").at(1), answer.at("goal").at("y"));
        EXPECT_EQ(goal.at("properties").at("target").at(0), answer.at("target").at("x"));
        EXPECT_EQ(goal.at("properties").at("target").at(1), answer.at("target").at("y"));
    }
}

TEST_F(ApiGoalsTest, GoalOfARobotEqualsTheAssignedOne) {
    const auto none = goal_of("r1");
    EXPECT_EQ(none.at("outcome"), "none");
    EXPECT_TRUE(none.at("goal").is_null() && none.at("path").is_null() && none.at("length").is_null());
    const auto assigned = ask_for_goal("r1");
    const auto shown = goal_of("r1");
    for (const auto& member : shown.as_object()) EXPECT_EQ(member.value(), assigned.at(member.key())) << member.key();
    goals_.paths().set_path(registry_.find("a"), 0,
                            guidance::HeldPath{guidance::PathKind::kPlan, {{0.5, 1.25}}, 0.0, 3},
                            guidance::RobotPaths::Clock::now());
    EXPECT_EQ(goal_of("r1").at("goal"), assigned.at("goal"));
    EXPECT_TRUE(goal_of("r1").at("path").is_null()) << "its path leads to another place";
}

TEST_F(ApiGoalsTest, ReadingGoalsDoesNotChangeThem) {
    stream("a", "r2", {scan_with_a_gap(2.0)});
    ask_for_goal("r1");
    const auto before = text();
    EXPECT_EQ(text(), before);
    goal_of("r1");
    goal_of("r2");
    EXPECT_EQ(get_json("/api/v1/sessions/a/frontiers.geojson").at("any_reachable"), true);
    EXPECT_EQ(ask("POST", "/api/v1/sessions/a/plan", R"({"from":{"robot":"r1"},"to":[2.5,0.2]})").status, Status::ok);
    EXPECT_EQ(ask("POST", "/api/v1/sessions/a/coverage", R"({"start":{"robot":"r1"}})").status, Status::ok);
    EXPECT_EQ(text(), before) << "a request without a robot stores no path";
    ask_for_goal("r1");
    EXPECT_NE(text(), before);
}

TEST_F(ApiGoalsTest, EndedGoalsAreNotShown) {
    ask_for_goal("r1");
    EXPECT_EQ(features().size(), 2U);
    EXPECT_EQ(ask_for_goal("r1", 100'000).at("outcome"), "complete");
    EXPECT_EQ(goal_of("r1").at("outcome"), "complete");
    EXPECT_THAT(features(), IsEmpty());
    EXPECT_EQ(goals().at("explored"), (boost::json::array{"r1"}));
    ask_for_goal("r1");
    EXPECT_EQ(goals().at("explored"), boost::json::array());
    const auto revision = goals().at("revision").to_number<int>();
    leave(0);
    EXPECT_THAT(features(), IsEmpty());
    EXPECT_GT(goals().at("revision").to_number<int>(), revision);
}

TEST_F(ApiGoalsTest, UnknownParametersAreRefused) {
    EXPECT_THAT(detail(get(std::string(kTarget) + "?weave=x"), Status::bad_request), HasSubstr("weave"));
}

// Assigning goals

TEST_F(ApiGoalsTest, GoalIsTheFrontierWithTheCheapestPath) {
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

TEST_F(ApiGoalsTest, TwoRobotsGetDifferentFrontiersUntilNoneIsLeft) {
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

TEST_F(ApiGoalsTest, UnobservableFrontierCellsAreGivenUp) {
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

TEST_F(ApiGoalsTest, RobotWithoutPoseHasNoGoal) {
    join("a", "mute", 1);
    EXPECT_THAT(detail(post("goal", R"({"robot":"mute"})"), Status::conflict), HasSubstr("has sent no scan yet"));
}

TEST_F(ApiGoalsTest, InvalidGoalRequestsAreRefused) {
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
    EXPECT_THAT(detail(post("goal?until=3", R"({"robot":"r1"})"), Status::bad_request),
                HasSubstr("POST them to .../weave"));
    EXPECT_THAT(detail(post("goal", R"({"robot":"none"})"), Status::not_found), HasSubstr(R"(robot is "none")"));
    EXPECT_EQ(post("goal?weave=0123456789abcdef", R"({"robot":"r1"})").status, Status::not_found);
    const std::string goal = "/api/v1/sessions/a/goal";
    EXPECT_THAT(detail(get(goal), Status::bad_request), StartsWith("robot is missing"));
    EXPECT_THAT(detail(get(goal + "?robot=r1&colour=red"), Status::bad_request),
                StartsWith("the parameter \"colour\" is unknown"));
    EXPECT_THAT(detail(get(goal + "?robot=r9"), Status::not_found),
                StartsWith("robot is \"r9\": these maps have no robot"));
}

} // namespace
} // namespace scanloom::http
