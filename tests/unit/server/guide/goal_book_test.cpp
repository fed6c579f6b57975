#include "server/guide/goal_book.hpp"

#include "tests/support/class_map.hpp"
#include "tests/unit/server/session/session_fixture.hpp"

#include <array>
#include <string>
#include <thread>

namespace scanloom::guide {
namespace {

using planning::Exploration;

/// A corridor whose two ends are not explored: a frontier on the left, one on the right.
class GoalBookTest : public session::SessionTest {
protected:
    void SetUp() override {
        SessionTest::SetUp();
        maps_.config.cell_size = 0.1;
        maps_.classes = testing_support::drawn({"##############################", //
                                                "f............................f", //
                                                "f............................f", //
                                                "f............................f", //
                                                "##############################"});
    }

    /// The next goal of a robot that stands somewhat left of the middle: which end it is of.
    char next(RobotIndex robot) { return next(robot, session_); }
    char next(RobotIndex robot, const std::shared_ptr<session::Session>& session) {
        const auto goal = book_.next(session, maps_, robot, {1.2, 0.25}, now_, kPoint).value();
        if (goal.outcome == Exploration::kTakenByOthers) return '-';
        if (goal.outcome == Exploration::kComplete) return 'c';
        return goal.path.points.back().x() < 1.5 ? 'l' : 'r';
    }

    void leave(const std::shared_ptr<session::RecordedLink>& link) {
        session_->leave(link);
        run();
    }

    static constexpr planning::ExplorationOptions kPoint{
        .passability = {.body_radius_m = 0.0}, .frontier_size_min = 1, .standoff_m = 1.0};

    mapping::Snapshot maps_;
    GoalBook book_;
    GoalBook::Clock::time_point now_{};
};

TEST_F(GoalBookTest, NoTwoRobotsGetTheSameFrontier) {
    for (const char* robot : {"a", "b", "c"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    EXPECT_EQ(next(1), 'r');
    EXPECT_EQ(next(2), '-');
    EXPECT_EQ(next(1), 'r') << "asking again";
    EXPECT_EQ(next(0), 'l');
}

TEST_F(GoalBookTest, WhoAsksAgainGivesBackWhatItHad) {
    for (const char* robot : {"a", "b"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    maps_.classes = testing_support::drawn({"f............................f"});
    ASSERT_TRUE(book_.next(session_, maps_, 0, {2.8, 0.05}, now_, kPoint)); // now nearer to the right
    EXPECT_EQ(book_.next(session_, maps_, 1, {1.2, 0.05}, now_, kPoint).value().path.points.back().x() < 1.5, true);
}

TEST_F(GoalBookTest, AGoalCountsNoLongerWhenItsRobotHasLeft) {
    const auto link = join("a");
    join("b");
    EXPECT_EQ(next(0), 'l');
    leave(link);
    EXPECT_EQ(next(1), 'l');
    join("a");
    EXPECT_EQ(next(0), 'r') << "it comes back and asks again";
}

TEST_F(GoalBookTest, AGoalOfAConnectedRobotCountsHoweverLongItTakes) {
    for (const char* robot : {"a", "b"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    now_ += std::chrono::hours(10);
    EXPECT_EQ(next(1), 'r');
}

TEST_F(GoalBookTest, AGoalOnBehalfOfAnAbsentRobotCountsForAWhile) {
    for (const char* robot : {"a", "b", "c"}) leave(join(robot));
    EXPECT_EQ(next(0), 'l');
    now_ += GoalBook::kKeptForAbsent;
    EXPECT_EQ(next(1), 'r');
    now_ += std::chrono::seconds(1);
    EXPECT_EQ(next(2), 'l');
}

TEST_F(GoalBookTest, ARobotThatConnectsKeepsTheGoalUntilItLeaves) {
    leave(join("a"));
    join("b");
    EXPECT_EQ(next(0), 'l');
    const auto link = join("a");
    EXPECT_EQ(next(1), 'r');
    now_ += 2 * GoalBook::kKeptForAbsent;
    EXPECT_EQ(next(1), 'r');
    leave(link);
    EXPECT_EQ(next(1), 'l');
}

TEST_F(GoalBookTest, GoalsAreTakenFromMapsOfOtherCellsToo) {
    for (const char* robot : {"a", "b"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    maps_.config.cell_size = 0.05;
    const std::string row = "f" + std::string(58, '.') + "f";
    maps_.classes = testing_support::drawn({row});
    EXPECT_GT(book_.next(session_, maps_, 1, {1.2, 0.025}, now_, kPoint).value().path.points.back().x(), 1.5);
}

TEST_F(GoalBookTest, ARefusedRequestLeavesNoGoal) {
    for (const char* robot : {"a", "b"}) join(robot);
    EXPECT_EQ(next(0), 'l');
    EXPECT_FALSE(book_.next(session_, maps_, 0, {100.0, 0.25}, now_, kPoint));
    EXPECT_EQ(next(1), 'l');
}

TEST_F(GoalBookTest, SessionsDoNotShareGoals) {
    join("a");
    EXPECT_EQ(next(0), 'l');
    const auto first = session_;
    start_session();
    EXPECT_EQ(next(0), 'l') << "robot 0 of another session";
    EXPECT_EQ(next(1, first), 'r');
}

TEST_F(GoalBookTest, RobotsThatAskAtTheSameMomentGetDifferentFrontiers) {
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
} // namespace scanloom::guide
