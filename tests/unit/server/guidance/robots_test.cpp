#include "server/guidance/robots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::guidance {
namespace {

mapping::Snapshot two_robots() {
    mapping::Snapshot maps;
    maps.robots.resize(2);
    maps.robots[0].name = "mute";
    maps.robots[1].name = "r";
    maps.robots[1].pose = Pose2{1.0, 2.0, 0.5};
    return maps;
}

TEST(Robots, AreFoundByName) {
    EXPECT_EQ(find_robot(two_robots(), "r").value(), 1U);
    EXPECT_EQ(find_robot(two_robots(), "R").error().code, Errc::kNotFound);
}

TEST(Robots, HaveThePoseOfTheirNewestScan) {
    EXPECT_EQ(pose_of(two_robots(), 1).value(), (Pose2{1.0, 2.0, 0.5}));
    const auto unknown = pose_of(two_robots(), 0);
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, Errc::kNoPath);
    EXPECT_THAT(unknown.error().message, testing::HasSubstr("'mute'"));
    EXPECT_EQ(pose_of(two_robots(), 2).error().code, Errc::kNoPath) << "the robot joined after the snapshot";
}

TEST(Robots, HaveNoPoseWhileTheyAreLost) {
    auto maps = two_robots();
    maps.robots[1].localization.state = LocalizationState::kLost;
    const auto lost = pose_of(maps, 1);
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().code, Errc::kNoPath);
    EXPECT_THAT(lost.error().message, testing::HasSubstr("'r' is not known: it is lost"));
}

} // namespace
} // namespace scanloom::guidance
