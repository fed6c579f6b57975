#include "server/guidance/robot_paths.hpp"

#include "tests/unit/server/sessions/session_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::guidance {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Counts change notifications.
struct CountingWatcher : sessions::Watcher {
    void on_changed() noexcept override { ++notified; }
    int notified = 0;
};

HeldPath path(PathKind kind, std::size_t points = 2) {
    HeldPath path{kind, {}, static_cast<double>(points - 1), 7};
    for (std::size_t n = 0; n < points; ++n) path.points.push_back({static_cast<double>(n), 0.0});
    return path;
}

class RobotPathsTest : public sessions::SessionTest {
protected:
    std::uint64_t give_goal(RobotIndex robot, std::size_t points = 2) {
        return book_.give_goal(session_, robot, kGoal, path(PathKind::kGoal, points), now_);
    }
    void set_path(RobotIndex robot, std::optional<HeldPath> given) {
        book_.set_path(session_, robot, std::move(given), now_);
    }
    void leave(const std::shared_ptr<sessions::RecordedLink>& link) {
        session_->leave(link);
        run();
    }
    [[nodiscard]] RobotPaths::Page page() { return book_.page(session_, now_); }
    [[nodiscard]] std::uint64_t revision() { return book_.state(session_, now_).revision; }

    static inline const Goal kGoal{{1.0, 2.0}, {1.5, 2.0}, true, 7};

    RobotPaths book_;
    RobotPaths::Clock::time_point now_{};
};

TEST_F(RobotPathsTest, IsEmptyInitially) {
    join("a");
    EXPECT_EQ(revision(), 0U);
    EXPECT_THAT(page().robots, IsEmpty());
    book_.take_back(session_, 0);
    set_path(0, std::nullopt);
    EXPECT_EQ(revision(), 0U);
}

TEST_F(RobotPathsTest, ListsFinishedRobotsUntilTheirNextRequestEvenIfAbsent) {
    const auto link = join("a");
    join("b");
    give_goal(0);
    const auto before = revision();
    book_.take_back(session_, 0, true);
    EXPECT_GT(revision(), before);
    EXPECT_THAT(page().robots, IsEmpty());
    EXPECT_THAT(page().explored, ElementsAre(0U));
    const auto explored = revision();
    book_.take_back(session_, 0, true);
    EXPECT_EQ(revision(), explored) << "an unchanged state keeps the revision";
    leave(link);
    EXPECT_THAT(page().explored, ElementsAre(0U));
    book_.take_back(session_, 1, true);
    EXPECT_THAT(page().explored, ElementsAre(0U, 1U));
    give_goal(0);
    EXPECT_THAT(page().explored, ElementsAre(1U));
    const auto last = revision();
    book_.take_back(session_, 1);
    EXPECT_THAT(page().explored, IsEmpty());
    EXPECT_GT(revision(), last);
}

TEST_F(RobotPathsTest, RobotHoldsItsGoalAndItsNewestPath) {
    for (const char* robot : {"a", "b"}) join(robot);
    set_path(1, path(PathKind::kCoverage));
    give_goal(0);
    auto now = page();
    ASSERT_EQ(now.robots.size(), 2U);
    EXPECT_EQ(now.robots[0].robot, 0U);
    EXPECT_EQ(now.robots[0].goal->place, kGoal.place);
    EXPECT_EQ(now.robots[0].path->kind, PathKind::kGoal);
    EXPECT_FALSE(now.robots[1].goal);
    EXPECT_EQ(now.robots[1].path->kind, PathKind::kCoverage);

    set_path(0, path(PathKind::kPlan));
    EXPECT_TRUE(page().robots[0].goal) << "a plan can lead to the goal";
    EXPECT_EQ(page().robots[0].path->kind, PathKind::kPlan);
    set_path(0, std::nullopt);
    EXPECT_TRUE(page().robots[0].goal);
    EXPECT_EQ(page().robots[0].path, nullptr);
    give_goal(0);
    EXPECT_EQ(page().robots[0].path->kind, PathKind::kGoal);
    give_goal(1);
    EXPECT_EQ(page().robots[1].path->kind, PathKind::kGoal) << "the newest path of any kind is kept";
    book_.take_back(session_, 0);
    EXPECT_EQ(page().robots.size(), 1U);
    set_path(0, path(PathKind::kPlan));
    set_path(0, std::nullopt);
    EXPECT_EQ(page().robots.size(), 1U) << "a robot without goal and path is not listed";
}

TEST_F(RobotPathsTest, OnlyChangesRaiseTheRevisionAndNotify) {
    const auto link = join("a");
    const auto watcher = std::make_shared<CountingWatcher>();
    session_->watch(watcher);
    std::uint64_t before = 0;
    const auto expect_change = [&](const char* what) {
        EXPECT_GT(revision(), before) << what;
        EXPECT_EQ(watcher->notified, 1) << what;
        before = revision();
        watcher->notified = 0;
    };
    give_goal(0);
    expect_change("a goal");
    set_path(0, path(PathKind::kPlan));
    expect_change("a plan");
    set_path(0, path(PathKind::kPlan));
    expect_change("another plan");
    set_path(0, std::nullopt);
    expect_change("no path");
    set_path(0, std::nullopt);
    static_cast<void>(page());
    EXPECT_EQ(revision(), before) << "requests do not change the revision";
    EXPECT_EQ(watcher->notified, 0);
    book_.take_back(session_, 0);
    expect_change("taken back");
    give_goal(0);
    expect_change("a goal again");
    leave(link);
    expect_change("left");
    book_.take_back(session_, 0);
    EXPECT_EQ(revision(), before);
    EXPECT_EQ(watcher->notified, 0);
}

TEST_F(RobotPathsTest, LeavingReleasesGoalAndPathForGood) {
    const auto link = join("a");
    const auto goal = give_goal(0);
    now_ += std::chrono::hours(10);
    EXPECT_EQ(page().robots.size(), 1U);
    EXPECT_TRUE(book_.holds(session_, 0, goal, now_));
    leave(link);
    EXPECT_THAT(page().robots, IsEmpty());
    EXPECT_FALSE(book_.holds(session_, 0, goal, now_));
    join("a");
    EXPECT_THAT(page().robots, IsEmpty());
}

TEST_F(RobotPathsTest, PathOfAnAbsentRobotIsDiscarded) {
    leave(join("a"));
    set_path(0, path(PathKind::kPlan));
    EXPECT_THAT(page().robots, IsEmpty());
}

TEST_F(RobotPathsTest, GoalOfAnAbsentRobotExpires) {
    leave(join("a"));
    EXPECT_EQ(book_.state(session_, now_).until, RobotPaths::Clock::time_point::max());
    give_goal(0);
    const auto state = book_.state(session_, now_);
    EXPECT_GT(state.until, now_);
    now_ = state.until - RobotPaths::Clock::duration(1);
    EXPECT_EQ(revision(), state.revision);
    now_ = state.until;
    EXPECT_GT(revision(), state.revision) << "the goal expires at the announced time";
    EXPECT_THAT(page().robots, IsEmpty());
}

TEST_F(RobotPathsTest, ConnectingKeepsTheGoalUntilTheRobotLeaves) {
    leave(join("a"));
    give_goal(0);
    const auto link = join("a");
    EXPECT_EQ(book_.state(session_, now_).until, RobotPaths::Clock::time_point::max());
    now_ += 2 * RobotPaths::kKeptForAbsent;
    EXPECT_EQ(page().robots.size(), 1U);
    leave(link);
    EXPECT_THAT(page().robots, IsEmpty());
}

TEST_F(RobotPathsTest, EachGoalHasItsOwnNumber) {
    join("a");
    const auto first = give_goal(0);
    const auto second = give_goal(0);
    EXPECT_FALSE(book_.holds(session_, 0, first, now_));
    EXPECT_TRUE(book_.holds(session_, 0, second, now_));
    set_path(0, path(PathKind::kPlan));
    EXPECT_TRUE(book_.holds(session_, 0, second, now_));
    book_.take_back(session_, 0);
    EXPECT_FALSE(book_.holds(session_, 0, second, now_));
}

TEST_F(RobotPathsTest, StateIsPerSessionAndEndsWithIt) {
    join("a");
    give_goal(0);
    const std::weak_ptr<sessions::Session> before = session_;
    start_session(); // another session
    join("a");
    EXPECT_TRUE(before.expired()) << "RobotPaths does not keep the session";
    EXPECT_EQ(revision(), 0U);
    EXPECT_THAT(page().robots, IsEmpty());
}

TEST_F(RobotPathsTest, TruncatesLongPathAtItsEnd) {
    join("a");
    set_path(0, path(PathKind::kCoverage, RobotPaths::kShownPathPointsMax));
    EXPECT_EQ(page().robots[0].path->points_left_out, 0U);
    set_path(0, path(PathKind::kCoverage, RobotPaths::kShownPathPointsMax + 5));
    const auto kept = page().robots[0].path;
    EXPECT_EQ(kept->points.size(), RobotPaths::kShownPathPointsMax);
    EXPECT_EQ(kept->points.back().x, static_cast<double>(RobotPaths::kShownPathPointsMax - 1));
    EXPECT_EQ(kept->points_left_out, 5U);
    EXPECT_EQ(kept->length_m, static_cast<double>(RobotPaths::kShownPathPointsMax + 4))
        << "the length includes the omitted points";
}

TEST_F(RobotPathsTest, TotalPathPointsPerSessionAreBounded) {
    constexpr std::size_t kFull = RobotPaths::kSessionPathPointsMax / RobotPaths::kShownPathPointsMax;
    for (RobotIndex robot = 0; robot <= kFull; ++robot) give_goal(robot, RobotPaths::kShownPathPointsMax);
    auto now = page();
    ASSERT_EQ(now.robots.size(), kFull + 1) << "absent robots keep their goals until they expire";
    EXPECT_EQ(now.robots[kFull - 1].path->points.size(), RobotPaths::kShownPathPointsMax);
    EXPECT_EQ(now.robots[kFull].path->points.size(), 2U);
    EXPECT_EQ(now.robots[kFull].path->points_left_out, RobotPaths::kShownPathPointsMax - 2);
    give_goal(0, RobotPaths::kShownPathPointsMax);
    EXPECT_EQ(page().robots[0].path->points.size(), RobotPaths::kShownPathPointsMax - 2)
        << "its own previous points are released";
}

} // namespace
} // namespace scanloom::guidance
