#include "robot_client/sources/stationary_phases.hpp"

#include "tests/unit/robot_client/sources/carried_lidar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Pose2 kFirstPlace{1.0, 2.0, 0.5};
const LocateResult kLocated{{3.0, 4.0, 1.0}, 0.93, 0.02, 0.01};
const Error kRefusal{Errc::kAmbiguous, "it may be here or there"};

class StationaryPhasesTest : public testing::Test {
protected:
    void add(std::vector<Observation> turns) {
        for (auto& turn : turns) {
            EXPECT_FALSE(phases_.question()) << "the question must be answered before the next turn";
            phases_.add(std::move(turn));
        }
    }
    void stand(const Pose2& place, std::size_t turns) { add(lidar_.turns_at(place, turns)); }
    void walk(const Pose2& from, const Pose2& to, std::size_t turns) { add(lidar_.turns_between(from, to, turns)); }

    std::vector<Scan> given() {
        std::vector<Scan> scans;
        while (auto turn = phases_.take()) scans.push_back(std::move(turn->scan));
        return scans;
    }

    CarriedLidar lidar_;
    StationaryPhases phases_{kFirstPlace};
};

TEST_F(StationaryPhasesTest, QuestionFollowsTenSimilarTurns) {
    stand(kHere, 9);
    EXPECT_FALSE(phases_.question());
    stand(kHere, 1);
    const auto question = phases_.question();
    ASSERT_TRUE(question);
    EXPECT_EQ(question->points().size(), 3600U);
    EXPECT_EQ(question->from(), (Point2{0.0, 0.0}));
    EXPECT_THAT(given(), IsEmpty());
}

TEST_F(StationaryPhasesTest, LocatedTurnsHaveTheLocatedPose) {
    stand(kHere, 10);
    phases_.answer(kLocated);
    EXPECT_THAT(
        phases_.take_messages(),
        ElementsAre(
            "localized at (3.00, 4.00), yaw 1.00: 93 % of the scan matches the map; accuracy 6.0 cm and 1.72 degrees"));
    auto scans = given();
    ASSERT_EQ(scans.size(), 7U) << "the newest three turns may belong to a beginning movement";
    for (std::size_t n = 0; n < scans.size(); ++n) {
        EXPECT_EQ(scans[n].pose, kLocated.T_map_odom);
        EXPECT_FALSE(scans[n].begins_map);
        EXPECT_NEAR(scans[n].stamp, 1000.0 + 0.1 * static_cast<double>(n), 1e-9);
    }
    stand(kHere, 5);
    EXPECT_EQ(given().size(), 5U);
    phases_.end();
    scans = given();
    ASSERT_EQ(scans.size(), 3U) << "the lidar was stationary until the end";
    EXPECT_NEAR(scans.back().stamp, 1001.4, 1e-9);
    EXPECT_EQ(phases_.given(), 15U);
    EXPECT_EQ(phases_.dropped(), 0U);
    EXPECT_EQ(phases_.carried(), 0U);
}

TEST_F(StationaryPhasesTest, TurnsOfAMovementAndJustBeforeAreDropped) {
    stand(kHere, 10);
    phases_.answer(kLocated);
    stand(kHere, 10);
    static_cast<void>(phases_.take_messages());
    const std::size_t before = given().size();
    walk(kHere, kThere, 30);
    EXPECT_THAT(phases_.take_messages(),
                ElementsAre(HasSubstr("the lidar was moved: no scans are sent until it is stationary")));
    EXPECT_THAT(given(), IsEmpty());
    EXPECT_EQ(phases_.carried(), 1U);
    stand(kThere, 9);
    EXPECT_FALSE(phases_.question());
    stand(kThere, 1);
    EXPECT_TRUE(phases_.question());
    phases_.answer(LocateResult{{5.0, 6.0, 0.0}, 0.9, 0.01, 0.01});
    phases_.end();
    const auto scans = given();
    EXPECT_EQ(scans.size(), 10U);
    EXPECT_EQ(scans.front().pose, (Pose2{5.0, 6.0, 0.0}));
    EXPECT_EQ(before, 17U);
    EXPECT_EQ(phases_.dropped(), 3U + 30U);
}

TEST_F(StationaryPhasesTest, MovingLidarAsksNoQuestion) {
    walk(kHere, kThere, 40);
    walk(kThere, {2.0, 0.0, -1.0}, 40);
    EXPECT_EQ(phases_.carried(), 0U) << "the lidar was never stationary";
    EXPECT_THAT(phases_.take_messages(), IsEmpty());
    EXPECT_GE(phases_.dropped(), 75U);
}

TEST_F(StationaryPhasesTest, PassingPeopleDoNotEndAHalt) {
    stand(kHere, 10);
    phases_.answer(kLocated);
    for (int n = 0; n < 30; ++n) {
        const Point2 at{kHere.x + 0.6, kHere.y - 1.5 + 0.1 * n};
        lidar_.world().walkers = {{.loop = {at, {at.x, at.y + 1.0}}}};
        stand(kHere, 1);
    }
    phases_.end();
    EXPECT_EQ(given().size(), 40U);
    EXPECT_EQ(phases_.carried(), 0U);
}

TEST_F(StationaryPhasesTest, TurnsWithoutReadingsDoNotEndAHalt) {
    stand(kHere, 5);
    const auto covered = [&] {
        auto turns = lidar_.turns_at(kHere, 3);
        for (auto& turn : turns) std::ranges::fill(turn.scan.ranges, kInvalidRange);
        add(std::move(turns));
    };
    covered();
    stand(kHere, 5);
    EXPECT_TRUE(phases_.question());
    phases_.answer(kLocated);
    covered();
    stand(kHere, 3);
    phases_.end();
    EXPECT_EQ(given().size(), 13U);
    EXPECT_EQ(phases_.dropped(), 6U);
}

TEST_F(StationaryPhasesTest, QuestionsAndPosesUseTheOdometryFrame) {
    const Pose2 odometry{0.5, -0.25, 1.0};
    auto turns = lidar_.turns_at(kHere, 10);
    for (auto& turn : turns) turn.scan.pose = odometry;
    add(std::move(turns));
    EXPECT_LT(norm(phases_.question()->from() - Point2{0.5, -0.25}), 1e-12);
    phases_.answer(kLocated);
    EXPECT_EQ(given().front().pose, compose(kLocated.T_map_odom, odometry));
}

TEST_F(StationaryPhasesTest, FirstHaltUsesTheGivenPoseInAnEmptyMap) {
    const Error nothing{Errc::kNothingMapped, "no laser has seen anything yet"};
    auto turns = lidar_.turns_at(kHere, 10);
    for (auto& turn : turns) turn.scan.pose = {5.0, 5.0, -2.0};
    add(std::move(turns));
    phases_.answer(nothing);
    EXPECT_THAT(phases_.take_messages(), ElementsAre("the map is empty: the lidar's pose is assumed to be (1.00, "
                                                     "2.00), yaw 0.50; its next places are localized relative to it"));
    const auto scans = given();
    ASSERT_EQ(scans.size(), 7U);
    EXPECT_NEAR(scans[0].pose->x, kFirstPlace.x, 1e-12);
    EXPECT_NEAR(scans[0].pose->y, kFirstPlace.y, 1e-12);
    EXPECT_NEAR(scans[0].pose->yaw, kFirstPlace.yaw, 1e-12);
    EXPECT_TRUE(std::ranges::all_of(scans, &Scan::begins_map)) << "the first scan may be dropped by a full spool";
    EXPECT_FALSE(phases_.refusal());

    walk(kHere, kThere, 30);
    stand(kThere, 10);
    static_cast<void>(phases_.take_messages());
    phases_.answer(nothing);
    EXPECT_THAT(phases_.take_messages(), ElementsAre(HasSubstr("; the given pose was that of the first place;")));
    phases_.end();
    EXPECT_THAT(given(), IsEmpty()) << "only the first place begins the map";
}

TEST_F(StationaryPhasesTest, RefusedQuestionIsRepeatedAfterTenSeconds) {
    stand(kHere, 10);
    phases_.answer(kRefusal);
    EXPECT_EQ(phases_.refusal(), kRefusal);
    stand(kHere, 99); // until 9.9 s after the last turn of the question
    EXPECT_EQ(phases_.dropped(), 10U + 89U);
    stand(kHere, 1);
    ASSERT_TRUE(phases_.question());
    phases_.answer(kLocated);
    phases_.end();
    const auto scans = given();
    EXPECT_EQ(scans.size(), 10U);
    EXPECT_NEAR(scans.front().stamp, 1010.0, 1e-6) << "the scans are newer than those of the refused question";
    EXPECT_EQ(phases_.carried(), 0U);
}

TEST_F(StationaryPhasesTest, RefusedQuestionIsRepeatedAfterAClockStepBack) {
    stand(kHere, 10);
    phases_.answer(kRefusal);
    lidar_.let_time_pass(-500.0);
    stand(kHere, 10);
    EXPECT_TRUE(phases_.question());
}

TEST_F(StationaryPhasesTest, QuestionAtAnotherPlaceIsImmediate) {
    stand(kHere, 10);
    phases_.answer(kRefusal);
    walk(kHere, kThere, 30);
    stand(kThere, 10);
    EXPECT_TRUE(phases_.question());
    EXPECT_EQ(phases_.carried(), 1U);
}

TEST_F(StationaryPhasesTest, EachMessageIsReportedOnce) {
    const std::string message =
        "it may be here or there; no scans are sent from here; retrying in 10 s, or at another place";
    const auto ask = [&](const Error& refusal) {
        stand(kHere, 10);
        lidar_.let_time_pass(10.0);
        phases_.answer(refusal);
        return phases_.take_messages();
    };
    EXPECT_THAT(ask(kRefusal), ElementsAre(message));
    EXPECT_THAT(ask(kRefusal), IsEmpty());
    EXPECT_THAT(ask({Errc::kOverloaded, "busy"}), ElementsAre(HasSubstr("busy; no scans are sent")));
    EXPECT_THAT(ask(kRefusal), IsEmpty());
    walk(kHere, kThere, 30);
    walk(kThere, kHere, 30);
    static_cast<void>(phases_.take_messages());
    EXPECT_THAT(ask(kRefusal), ElementsAre(message));
}

} // namespace
} // namespace scanloom::robot
