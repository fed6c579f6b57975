#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <string>

namespace scanloom::http {
namespace {

using testing::IsEmpty;

/// A wall around the robot at 3 m, with a sector without readings: frontiers are in that sector and behind the wall.
Scan scan_with_a_gap(double x) {
    Scan taken = scan(1);
    taken.pose->x = x;
    taken.ranges.assign(181, 3'000);
    std::fill(taken.ranges.begin() + 100, taken.ranges.begin() + 130, kInvalidRange);
    return taken;
}

class ApiGoalsTest : public ApiTest {
protected:
    ApiGoalsTest() {
        create("a");
        stream("a", "r1", {scan_with_a_gap(0.5)});
    }

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

    static constexpr const char* kTarget = "/api/v1/sessions/a/goals.geojson";
};

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

} // namespace
} // namespace scanloom::http
