#include "lab/trajectory_variants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::lab {
namespace {

using robot::StampedPose;
using testing::ElementsAre;

std::vector<std::size_t> skips_without_odometry(std::size_t scans) {
    std::vector<std::size_t> skips;
    for (const auto& [poses, perturbation] : variants_of(scans)) {
        if (poses == Poses::kNone) skips.push_back(perturbation.skip);
    }
    return skips;
}

TEST(TrajectoryVariants, ChangeOdometryScansAndStart) {
    const auto variants = variants_of(13'631);
    EXPECT_EQ(variants.size(), 30U);
    const auto with = [&](double scale) {
        std::vector<std::string> texts;
        for (const Variant& variant : variants) {
            if (variant.poses == Poses::kOdometry && variant.perturbation.odometry_scale == scale) {
                texts.push_back(text_of(variant));
            }
        }
        return texts;
    };
    for (const double scale : {0.97, 0.98, 0.99, 1.01, 1.02, 1.03}) EXPECT_EQ(with(scale).size(), 4U) << scale;
    EXPECT_THAT(with(0.97),
                ElementsAre("odometry x 0.97", "odometry x 0.97, without the first 700 scans",
                            "odometry x 0.97, without the first 2100 scans", "odometry x 0.97, one scan of 2"));
    EXPECT_EQ(text_of(variants.back()), "no odometry, without the first 2100 scans");
    EXPECT_EQ(text_of({}), "odometry unchanged");
}

TEST(TrajectoryVariants, StartsAreMultiplesOfARoundedTwentieth) {
    EXPECT_THAT(skips_without_odometry(13'631), ElementsAre(350, 700, 1050, 1400, 1750, 2100));
    EXPECT_THAT(skips_without_odometry(4'934), ElementsAre(150, 300, 450, 600, 750, 900));
    EXPECT_THAT(skips_without_odometry(4'000), ElementsAre(100, 200, 300, 400, 500, 600));
    EXPECT_THAT(skips_without_odometry(181), ElementsAre(5, 10, 15, 20, 25, 30));
    EXPECT_THAT(skips_without_odometry(10), ElementsAre(1, 1, 1, 2, 2, 3));
}

/// Returns a trajectory through some places with headings, at stamps that do not matter.
std::vector<StampedPose> trajectory(std::initializer_list<Pose2> poses) {
    std::vector<StampedPose> stamped;
    for (const Pose2& pose : poses) stamped.push_back({pose, 0.0});
    return stamped;
}

std::vector<StampedPose> moved(std::vector<StampedPose> poses, const Pose2& motion) {
    for (auto& pose : poses) pose.robot = compose(motion, pose.robot);
    return poses;
}

const auto kWay = trajectory({{0, 0, 0}, {3, 0, 0.5}, {3, 4, 2.0}, {-1, 5, 3.0}, {-2, 1, -2.0}});

TEST(TrajectoryDistances, AreZeroAfterARigidMotion) {
    for (const Pose2& motion : {Pose2{10, -3, 1.0}, Pose2{0, 0, 3.1}, Pose2{-5, 0, -2.5}}) {
        const auto distance = distance_between(kWay, moved(kWay, motion));
        EXPECT_NEAR(distance.metres, 0.0, 1e-12);
        EXPECT_NEAR(distance.degrees, 0.0, 1e-10);
    }
}

TEST(TrajectoryDistances, AreTheLargestOfAnyScan) {
    // The best motion is known by symmetry: none, in the frame of the reference.
    const auto whole = trajectory({{-1, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, -2, 0}});
    const auto stretched = trajectory({{-1.25, 0, 0.1}, {1.25, 0, 0}, {0, 2.75, 0}, {0, -2.75, -0.2}});
    for (const Pose2& motion : {Pose2{}, Pose2{7, 8, 2.0}}) {
        const auto distance = distance_between(whole, moved(stretched, motion));
        EXPECT_NEAR(distance.metres, 0.75, 1e-12);
        EXPECT_NEAR(distance.degrees, 0.2 * 180.0 / std::numbers::pi, 1e-10);
    }
}

TEST(TrajectoryDistances, CountTurnedScans) {
    const double degree = std::numbers::pi / 180.0;
    const auto whole = trajectory({{-1, 0, 0}, {1, 0, 3.1}, {0, 2, 0}, {0, -2, 0}});
    const auto turned =
        trajectory({{-1, 0, 4.9 * degree}, {1, 0, 3.1 + 5.1 * degree}, {0, 2, -90 * degree}, {0, -2, 0}});
    EXPECT_EQ(distance_between(whole, turned).turned_scans, 2U);
    EXPECT_EQ(distance_between(whole, whole).turned_scans, 0U);
}

TEST(TrajectoryParts, HaveTheScansThatThePerturbationLeaves) {
    const auto x_of = [](const std::vector<StampedPose>& poses) {
        std::vector<double> x;
        for (const auto& pose : poses) x.push_back(pose.robot.x);
        return x;
    };
    const auto whole = trajectory({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
    EXPECT_THAT(x_of(part_of(whole, {})), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(x_of(part_of(whole, {.skip = 1, .every = 2})), ElementsAre(1, 3));
    EXPECT_THAT(x_of(part_of(whole, {.every = 3})), ElementsAre(0, 3));
    EXPECT_TRUE(part_of(whole, {.skip = 5}).empty());
}

TEST(TrajectoryDistances, AboveEitherLimitAreFalseLoops) {
    EXPECT_FALSE(is_false_loop({0.5, 15.0}));
    EXPECT_TRUE(is_false_loop({0.51, 0.0}));
    EXPECT_TRUE(is_false_loop({0.0, 15.1}));
}

} // namespace
} // namespace scanloom::lab
