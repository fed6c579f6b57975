#include "robot_client/sources/pose_path.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PoseLine, ContainsStampAndPose) {
    const auto pose = read_pose_line("  1.5\t-2 3e1 7 and what stands behind\r").value().value();
    EXPECT_EQ(pose.stamp, 1.5);
    EXPECT_EQ(pose.robot.x, -2.0);
    EXPECT_EQ(pose.robot.y, 30.0);
    EXPECT_DOUBLE_EQ(pose.robot.yaw, 7.0 - 2.0 * std::numbers::pi);
}

TEST(PoseLine, MayBeEmptyOrAComment) {
    for (const auto* line : {"", " \t", "# t x y yaw", "#", "  # 1 2 3 4"}) {
        EXPECT_FALSE(read_pose_line(line).value()) << line;
    }
}

TEST(PoseLine, InvalidLineIsRefusedWithTheReason) {
    EXPECT_THAT(read_pose_line("1 2 3").error().message, HasSubstr("3 values; 4 are needed"));
    EXPECT_THAT(read_pose_line("1 2 3 x").error().message, HasSubstr("'x' is not a number"));
    EXPECT_THAT(read_pose_line("1 2 nan 4").error().message, HasSubstr("'nan' is not finite"));
    EXPECT_THAT(read_pose_line("1e999 2 3 4").error().message, HasSubstr("'1e999' is not finite"));
    EXPECT_THAT(read_pose_line("1 2 1000001 4").error().message, HasSubstr("more than 1000000 m from the origin"));
}

TEST(PoseLines, BrokenLinesAreSkippedAndReported) {
    std::istringstream text("# comment\n1 0 0 0\nbroken\n\n2 1 0 0\n1 2\n");
    std::vector<std::size_t> skipped;
    const auto lines =
        read_pose_lines(text, "stdin", [&](const SkippedLine& line) { skipped.push_back(line.line_number); });
    ASSERT_TRUE(lines) << lines.error().message;
    EXPECT_EQ(lines->poses.size(), 2U);
    EXPECT_EQ(lines->skipped, 2U);
    EXPECT_THAT(skipped, ElementsAre(3, 6));
}

TEST(PoseLines, FilesAndStreamsAreReadAlike) {
    const TemporaryDirectory directory;
    const auto path = directory.path() / "poses";
    std::ofstream(path) << "2 1 0 0\nx\n1 0 0 0";
    const auto ignore = [](const SkippedLine&) {};
    const auto lines = read_pose_lines(path, ignore);
    ASSERT_TRUE(lines) << lines.error().message;
    EXPECT_EQ(lines->poses.oldest().stamp, 1.0);
    EXPECT_EQ(lines->poses.newest().stamp, 2.0);
    EXPECT_EQ(lines->skipped, 1U);
    EXPECT_FALSE(read_pose_lines(directory.path() / "absent", ignore));
    std::ofstream(path) << "# nothing\n";
    EXPECT_THAT(read_pose_lines(path, ignore).error().message, HasSubstr("no valid pose"));
}

TEST(PoseTimeline, InterpolatesYawAlongTheShorterArc) {
    PoseTimeline poses;
    poses.insert({{2.0, -2.0, -3.0}, 20.0});
    poses.insert({{1.0, 0.0, 3.0}, 10.0}); // in any order
    const Pose2 middle = poses.at(15.0).value();
    EXPECT_DOUBLE_EQ(middle.x, 1.5);
    EXPECT_DOUBLE_EQ(middle.y, -1.0);
    EXPECT_NEAR(std::abs(middle.yaw), std::numbers::pi, 1e-12);
    EXPECT_NEAR(poses.at(12.5).value().yaw, 3.0 + (std::numbers::pi - 3.0) / 2.0, 1e-12);
}

TEST(PoseTimeline, IsEmptyOutsideItsPoses) {
    PoseTimeline poses;
    EXPECT_FALSE(poses.at(0.0));
    poses.insert({{1.0, 0.0, 0.0}, 10.0});
    EXPECT_EQ(poses.at(10.0), (Pose2{1.0, 0.0, 0.0}));
    EXPECT_FALSE(poses.at(9.999));
    EXPECT_FALSE(poses.at(10.001));
    poses.insert({{2.0, 0.0, 0.0}, 1000.0});
    EXPECT_DOUBLE_EQ(poses.at(505.0).value().x, 1.5) << "poses are interpolated at any distance";
    EXPECT_EQ(poses.at(1000.0).value().x, 2.0);
    EXPECT_FALSE(poses.at(1000.001));
}

TEST(PoseTimeline, AcceptsSeveralPosesWithOneStamp) {
    PoseTimeline poses;
    for (const double x : {1.0, 2.0, 3.0}) poses.insert({{x, 0.0, 0.0}, 10.0});
    EXPECT_TRUE(poses.at(10.0));
}

TEST(PoseTimeline, KeepsTheNewestPoses) {
    PoseTimeline poses;
    for (int i = 0; i < 10; ++i) poses.insert({{0.0, 0.0, 0.0}, static_cast<double>(i)});
    poses.keep_newest(3);
    EXPECT_EQ(poses.size(), 3U);
    EXPECT_EQ(poses.oldest().stamp, 7.0);
    const std::size_t before = poses.size();
    poses.forget_after(poses.oldest().stamp);
    EXPECT_LT(poses.size(), before);
    EXPECT_EQ(poses.newest().stamp, poses.oldest().stamp);
}

} // namespace
} // namespace scanloom::robot
