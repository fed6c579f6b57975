#include "server/guidance/goal_assignments.hpp"

#include "tests/support/class_map.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <array>
#include <string>
#include <thread>

namespace scanloom::guidance {
namespace {

using planning::Exploration;

/// A corridor with two unexplored ends: one frontier on the left and one on the right.
class GoalAssignmentsTest : public sessions::SessionTest {
protected:
    void SetUp() override {
        SessionTest::SetUp();
        maps_.robots.resize(3);
        maps_.config.cell_size = 0.1;
        maps_.classes = testing_support::drawn({"##############################", //
                                                "f............................f", //
                                                "f............................f", //
                                                "f............................f", //
                                                "##############################"});
    }

    /// Returns the end ('l' or 'r') to which the robot's next goal leads. The robot stands left of the middle.
    char next(RobotIndex robot) { return next(robot, session_); }
    char next(RobotIndex robot, const std::shared_ptr<sessions::Session>& session) {
        const auto goal = book_.next(session, maps_, robot, {1.2, 0.25}, now_, kPoint).value();
        if (goal.outcome == Exploration::kTakenByOthers) return '-';
        if (goal.outcome == Exploration::kComplete) return 'c';
        return goal.path.points.back().x < 1.5 ? 'l' : 'r';
    }

    planning::NextGoal request(RobotIndex robot) {
        return book_.next(session_, maps_, robot, {1.2, 0.25}, now_, kPoint).value();
    }

    /// Records a scan at the robot's goal, taken with a heading of `turned_away` (rad) relative to the target.
    void scan_at(const planning::NextGoal& goal, RobotIndex robot, double turned_away = 0.0) {
        const Point2 place = goal.path.points.back();
        const Point2 target =
            Point2{goal.goal->target.i + 0.5, goal.goal->target.j + 0.5} * maps_.config.cell_size - place;
        auto& state = maps_.robots[robot];
        state.pose = Pose2{place.x, place.y, std::atan2(target.y, target.x) + turned_away};
        state.scan_count += 1;
        state.stamp += 1.0;
        trajectory_.append({0, state.stamp, *state.pose});
        state.trajectory = trajectory_.snapshot();
    }

    void leave(const std::shared_ptr<sessions::RecordedLink>& link) {
        session_->leave(link);
        run();
    }

    static constexpr planning::ExplorationOptions kPoint{
        .passability = {.body_radius_m = 0.0}, .frontier_size_min = 1, .standoff_m = 1.0};

    mapping::Snapshot maps_;
    mapping::Trajectory trajectory_; // trajectory of the robot that records scans
    GoalAssignments book_;
    GoalAssignments::Clock::time_point now_{};
};

TEST_F(GoalAssignmentsTest, NewRequestReleasesThePreviousGoal) {
    for (const char* robot : {"a", "b"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    maps_.classes = testing_support::drawn({"f............................f"});
    ASSERT_TRUE(book_.next(session_, maps_, 0, {2.8, 0.05}, now_, kPoint)); // now nearer to the right end
    EXPECT_EQ(book_.next(session_, maps_, 1, {1.2, 0.05}, now_, kPoint).value().path.points.back().x < 1.5, true);
}

TEST_F(GoalAssignmentsTest, GoalIsReleasedWhenItsRobotLeaves) {
    const auto link = join("a");
    join("b");
    EXPECT_EQ(next(0), 'l');
    leave(link);
    EXPECT_EQ(next(1), 'l');
    join("a");
    EXPECT_EQ(next(0), 'r') << "the robot reconnects and requests a goal again";
}

TEST_F(GoalAssignmentsTest, GoalOfAnAbsentRobotExpires) {
    for (const char* robot : {"a", "b", "c"}) leave(join(robot));
    EXPECT_EQ(next(0), 'l');
    now_ += RobotPaths::kKeptForAbsent;
    EXPECT_EQ(next(1), 'r');
    now_ += std::chrono::seconds(1);
    EXPECT_EQ(next(2), 'l');
}

TEST_F(GoalAssignmentsTest, GoalExcludesItsFrontierAtOtherResolutions) {
    for (const char* robot : {"a", "b"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    maps_.config.cell_size = 0.05;
    const std::string row = "f" + std::string(58, '.') + "f";
    maps_.classes = testing_support::drawn({row});
    EXPECT_GT(book_.next(session_, maps_, 1, {1.2, 0.025}, now_, kPoint).value().path.points.back().x, 1.5);
}

TEST_F(GoalAssignmentsTest, RefusedRequestReleasesTheGoal) {
    for (const char* robot : {"a", "b"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    EXPECT_FALSE(book_.next(session_, maps_, 0, {100.0, 0.25}, now_, kPoint));
    EXPECT_EQ(next(1), 'l');
}

TEST_F(GoalAssignmentsTest, SessionsDoNotShareGoals) {
    join("a");
    EXPECT_EQ(next(0), 'l');
    const auto first = session_;
    start_session();
    EXPECT_EQ(next(0), 'l') << "robot 0 of another session";
    EXPECT_EQ(next(1, first), 'r');
}

// Frontiers that could not be observed

TEST_F(GoalAssignmentsTest, UnobservableFrontierIsExcludedForAllRobots) {
    for (const char* robot : {"a", "b"}) join(robot);
    const auto left = request(0);
    EXPECT_EQ(left.given_up, 0U);
    scan_at(left, 0);
    const auto right = request(0);
    EXPECT_GT(right.path.points.back().x, 1.5);
    EXPECT_EQ(right.given_up, 3U);
    EXPECT_EQ(next(1), '-') << "the left frontier is excluded for the other robot too";
    scan_at(right, 0);
    const auto end = request(0);
    EXPECT_EQ(end.outcome, Exploration::kComplete);
    EXPECT_EQ(end.given_up, 6U);
    EXPECT_EQ(next(1), 'c');
}

TEST_F(GoalAssignmentsTest, RobotThatHasNotObservedKeepsItsGoal) {
    join("a");
    const auto goal = request(0);
    const auto expect_same_goal = [&](const char* condition) {
        const auto again = request(0);
        EXPECT_EQ(again.goal->cell, goal.goal->cell) << condition;
        EXPECT_EQ(again.goal->target, goal.goal->target) << condition;
        EXPECT_EQ(again.given_up, 0U) << condition;
    };
    expect_same_goal("without a scan");
    scan_at(goal, 0, 3.0);
    expect_same_goal("with a heading away from the target");
    scan_at(goal, 0);
    maps_.robots[0].pose->x += 0.25;
    expect_same_goal("at a distance from the goal");
}

TEST_F(GoalAssignmentsTest, IgnoresScansFromBeforeTheGoal) {
    join("a");
    scan_at(request(0), 0);
    EXPECT_EQ(request(0).given_up, 3U);
    start_session();
    const auto goal = request(0);
    EXPECT_EQ(request(0).goal->target, goal.goal->target);
    scan_at(goal, 0);
    EXPECT_EQ(request(0).given_up, 3U);
}

TEST_F(GoalAssignmentsTest, FiveSecondsAtTheGoalCountAsObservation) {
    join("a");
    const auto goal = request(0);
    for (int second = 0; second < 10; ++second) scan_at(goal, 0, 3.0);
    for (int second = 0; second < 5; ++second) {
        EXPECT_EQ(request(0).given_up, 0U) << "the 5 s begin with the first request from the goal";
        scan_at(goal, 0, 3.0);
    }
    EXPECT_EQ(request(0).given_up, 3U);
}

TEST_F(GoalAssignmentsTest, CellThatIsNoLongerFrontierIsNotGivenUp) {
    join("a");
    const auto before = maps_.classes;
    scan_at(request(0), 0);
    EXPECT_EQ(request(0).given_up, 3U);
    maps_.revision = 1;
    maps_.classes = testing_support::drawn({"##############################", //
                                            "f............................f", //
                                            ".............................f", //
                                            "f............................f", //
                                            "##############################"});
    EXPECT_EQ(request(0).given_up, 2U);
    maps_.classes = before;
    maps_.revision = 2;
    const auto after = request(0);
    EXPECT_EQ(after.given_up, 2U);
    EXPECT_EQ(after.goal->target, (grid::Cell{0, 2})) << "the middle cell is a frontier cell again";
}

TEST_F(GoalAssignmentsTest, RecurringFrontierIsGivenUpAfterTwoObservations) {
    join("a");
    const auto open = maps_.classes;
    const auto closed = testing_support::drawn({"##############################", //
                                                "#............................f", //
                                                "#............................f", //
                                                "#............................f", //
                                                "##############################"});
    for (int observation = 0; observation < 2; ++observation) {
        const auto goal = request(0);
        EXPECT_EQ(goal.goal->target.i, 0) << "the left frontier is nearer";
        EXPECT_EQ(goal.given_up, 0U);
        scan_at(goal, 0);
        maps_.classes = closed;
        maps_.revision += 1;
        EXPECT_GT(request(0).goal->target.i, 0) << "the left end is closed";
        maps_.classes = open;
        maps_.revision += 1;
    }
    const auto goal = request(0);
    EXPECT_EQ(goal.given_up, 3U);
    EXPECT_GT(goal.goal->target.i, 0) << "the left frontier was observed twice";
    maps_.classes = closed;
    maps_.revision += 1;
    EXPECT_EQ(request(0).given_up, 0U) << "only FRONTIER cells are given up";
}

TEST_F(GoalAssignmentsTest, EarlierMapsDoNotRestoreGivenUpCells) {
    join("a");
    maps_.revision = 5;
    scan_at(request(0), 0);
    EXPECT_EQ(request(0).given_up, 3U);
    auto earlier = maps_;
    earlier.revision = 4;
    earlier.classes = testing_support::drawn({"....................", "....................", "...................."});
    ASSERT_TRUE(book_.next(session_, earlier, 0, {1.2, 0.25}, now_, kPoint));
    EXPECT_EQ(request(0).given_up, 3U);
}

TEST_F(GoalAssignmentsTest, RestoresTheOldestCellsBeyondTheLimit) {
    join("a");
    const std::string row = "." + std::string(299, 'f');
    maps_.classes = testing_support::drawn(std::vector<std::string_view>(300, row));
    auto options = kPoint;
    options.standoff_m = 100.0;
    const auto request_here = [&] { return book_.next(session_, maps_, 0, {0.05, 0.05}, now_, options).value(); };
    scan_at(request_here(), 0);
    const auto next = request_here();
    EXPECT_EQ(next.given_up, GoalAssignments::kUnobservedCellsMax);
    EXPECT_EQ(next.outcome, Exploration::kGoal);
}

TEST_F(GoalAssignmentsTest, RemovesTheLeastRecentlyUsedSettingsBeyondTheLimit) {
    join("a");
    for (std::size_t n = 0; n <= GoalAssignments::kSettingsMax; ++n) {
        maps_.config.danger_cells = static_cast<std::int32_t>(n) + 1;
        scan_at(request(0), 0);
        EXPECT_EQ(request(0).given_up, 3U);
    }
    EXPECT_EQ(request(0).given_up, 3U);
    maps_.config.danger_cells = 2;
    EXPECT_EQ(request(0).given_up, 3U);
    maps_.config.danger_cells = 1;
    EXPECT_EQ(request(0).given_up, 0U);
}

TEST_F(GoalAssignmentsTest, GivesUpOnlyVisibleCellsNearTheTarget) {
    join("a");
    const std::string far(14, '.');
    maps_.classes = testing_support::drawn({far + "f", far + "f", far + "f", far + "f", far + "f", far + "f", far + "f",
                                            far + "f", far + "f", far + "f", far + "f", far + "f", far + "f", far + "f",
                                            far + "f", far + "f"});
    const auto goal = request(0); // in row 2
    scan_at(goal, 0);
    const auto again = request(0);
    EXPECT_EQ(again.given_up, 13U) << "rows 0 to 12";
    EXPECT_GT(again.goal->target.j, 12);
}

TEST_F(GoalAssignmentsTest, GivenUpCellsArePerSessionAndSettings) {
    join("a");
    scan_at(request(0), 0);
    const auto right = request(0);
    EXPECT_EQ(right.given_up, 3U);
    scan_at(right, 0);
    auto other = maps_;
    other.config.danger_cells += 1;
    EXPECT_EQ(book_.next(session_, other, 0, {1.2, 0.25}, now_, kPoint).value().given_up, 0U);
    EXPECT_EQ(request(0).given_up, 3U);
    const auto first = session_;
    start_session();
    EXPECT_EQ(request(0).given_up, 0U);
}

TEST_F(GoalAssignmentsTest, ConcurrentRequestsGetDifferentFrontiers) {
    for (const char* robot : {"a", "b"}) join(robot);
    for (int round = 0; round < 50; ++round) {
        std::array<char, 2> got{};
        {
            std::jthread first([&] { got[0] = next(0); });
            std::jthread second([&] { got[1] = next(1); });
        }
        ASSERT_NE(got[0], got[1]);
    }
}

} // namespace
} // namespace scanloom::guidance
