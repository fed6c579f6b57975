#include "robot_client/ros/frame_tree.hpp"
#include "tests/support/ros_bytes.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace scanloom::robot {
namespace {

using testing_support::flat;

constexpr RosTime kSecond = 1'000'000'000;

Eigen::Isometry3d found(const FrameTree& tree, std::string_view target, std::string_view source, RosTime stamp) {
    const auto result = tree.find(target, source, stamp);
    EXPECT_TRUE(std::holds_alternative<Eigen::Isometry3d>(result)) << target << " " << source << " at " << stamp;
    const auto* transform = std::get_if<Eigen::Isometry3d>(&result);
    return transform != nullptr ? *transform : Eigen::Isometry3d::Identity();
}

NoTransform missing(const FrameTree& tree, std::string_view target, std::string_view source, RosTime stamp) {
    const auto result = tree.find(target, source, stamp);
    EXPECT_TRUE(std::holds_alternative<NoTransform>(result)) << target << " " << source << " at " << stamp;
    const auto* reason = std::get_if<NoTransform>(&result);
    return reason != nullptr ? *reason : NoTransform::kNotConnected;
}

TEST(FrameTree, InterpolatesBetweenTwoStampsAndNeverExtrapolates) {
    FrameTree tree;
    tree.add(flat(1 * kSecond, "odom", "base", 0.0, 0.0, 3.0), false);
    tree.add(flat(2 * kSecond, "odom", "base", 1.0, 4.0, -3.0), false);
    tree.add(flat(0, "base", "laser", 0.5), true);
    const auto middle = found(tree, "odom", "base", 3 * kSecond / 2);
    EXPECT_NEAR(middle.translation().x(), 0.5, 1e-12);
    EXPECT_NEAR(middle.translation().y(), 2.0, 1e-12);
    EXPECT_NEAR(std::fabs(std::atan2(middle.linear()(1, 0), middle.linear()(0, 0))), 3.14159265, 1e-6)
        << "the shorter way round";
    EXPECT_NEAR(found(tree, "odom", "laser", kSecond).translation().x(), 0.5 * std::cos(3.0), 1e-12);
    EXPECT_EQ(missing(tree, "odom", "laser", kSecond - 1), NoTransform::kBefore);
    EXPECT_EQ(missing(tree, "odom", "laser", 2 * kSecond + 1), NoTransform::kAfter);
    EXPECT_EQ(missing(tree, "map", "laser", kSecond), NoTransform::kNotConnected);
    EXPECT_NEAR(found(tree, "base", "laser", 99 * kSecond).translation().x(), 0.5, 1e-12)
        << "a static one, at any time";
}

TEST(FrameTree, AHoleIsNotInterpolatedUnlessNothingMoved) {
    FrameTree tree;
    tree.add(flat(0, "odom", "base", 1.0), false);
    tree.add(flat(10 * kSecond, "odom", "base", 1.0), false);
    tree.add(flat(13 * kSecond, "odom", "base", 2.0), false);
    EXPECT_EQ(found(tree, "odom", "base", 5 * kSecond).translation().x(), 1.0);
    EXPECT_EQ(missing(tree, "odom", "base", 12 * kSecond), NoTransform::kHole);
}

TEST(FrameTree, AFrameMayGetAnotherParent) {
    FrameTree tree;
    tree.add(flat(0, "a", "child", 1.0), false);
    tree.add(flat(kSecond, "a", "child", 2.0), false);
    tree.add(flat(2 * kSecond, "b", "child", 5.0), false);
    tree.add(flat(3 * kSecond, "b", "child", 5.0), false);
    EXPECT_EQ(found(tree, "a", "child", kSecond).translation().x(), 2.0);
    EXPECT_EQ(missing(tree, "a", "child", 3 * kSecond / 2), NoTransform::kHole);
    EXPECT_EQ(found(tree, "b", "child", 5 * kSecond / 2).translation().x(), 5.0);
    EXPECT_EQ(missing(tree, "a", "child", 5 * kSecond / 2), NoTransform::kNotConnected);
}

TEST(FrameTree, LoopsOfParentsEnd) {
    FrameTree tree;
    tree.add(flat(0, "a", "b", 1.0), true);
    tree.add(flat(0, "b", "c", 1.0), true);
    tree.add(flat(0, "c", "a", 1.0), true);
    EXPECT_EQ(missing(tree, "map", "a", 0), NoTransform::kNotConnected);
    EXPECT_EQ(tree.ancestors("c"), (std::vector<std::string>{"c", "b", "a"}));
    tree.add(flat(0, "x", "y", 1.0), true);
    EXPECT_EQ(missing(tree, "x", "a", 0), NoTransform::kLoop);
}

TEST(FrameTree, OfEqualTransformsInARowTwoAreKept) {
    FrameTree tree;
    for (RosTime n = 0; n < 1000; ++n) tree.add(flat(n * kSecond, "map", "odom", n < 500 ? 0.0 : 1.0), false);
    EXPECT_EQ(tree.size(), 4U);
    EXPECT_EQ(found(tree, "map", "odom", 498 * kSecond + 7).translation().x(), 0.0);
    EXPECT_NEAR(found(tree, "map", "odom", 499 * kSecond + kSecond / 4).translation().x(), 0.25, 1e-12);
    EXPECT_EQ(found(tree, "map", "odom", 800 * kSecond + 7).translation().x(), 1.0);
    tree.add(flat(7 * kSecond, "map", "odom", 9.0), false);
    tree.add(flat(7 * kSecond, "map", "odom", 8.0), false);
    EXPECT_EQ(found(tree, "map", "odom", 7 * kSecond).translation().x(), 9.0) << "the first of a stamp counts";
}

TEST(FrameTree, FramesThatNothingIsMountedOnAreRemoved) {
    FrameTree tree;
    tree.add(flat(0, "base", "laser", 1.0), true);
    tree.add(flat(0, "odom", "base", 1.0), false);
    for (RosTime n = 0; n < 50; ++n) tree.add(flat(n, "base", "wheel", static_cast<double>(n)), false);
    tree.keep_ancestors({"laser"});
    EXPECT_EQ(tree.size(), 2U);
    EXPECT_EQ(missing(tree, "base", "wheel", 5), NoTransform::kNotConnected);
    EXPECT_NEAR(found(tree, "odom", "laser", 0).translation().x(), 2.0, 1e-12);
}

TEST(FrameTree, TransformsOfAChildAreReplacedByThoseOfAnotherTree) {
    FrameTree tree;
    tree.add(flat(0, "map", "odom", 10.0), true);
    tree.add(flat(0, "odom", "base", 1.0), false);
    FrameTree other;
    other.add(flat(0, "unused", "also_unused", 5.0), true);
    other.add(flat(0, "odom", "base", 2.0), false);
    tree.replace("base", other, "base");
    EXPECT_NEAR(found(tree, "map", "base", 0).translation().x(), 12.0, 1e-12);
    EXPECT_EQ(tree.size(), 2U);
}

/// Random trees against matrices that are multiplied one by one from the root.
TEST(FrameTree, AgreesWithMatricesInRandomTrees) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-3.0, 3.0);
    for (int round = 0; round < 50; ++round) {
        FrameTree tree;
        constexpr std::size_t kFrames = 9;
        std::vector<std::size_t> parent(kFrames, 0);
        std::vector<RosTransform> first(kFrames);
        std::vector<RosTransform> second(kFrames);
        const auto name = [](std::size_t n) { return "frame" + std::to_string(n); };
        for (std::size_t n = 1; n < kFrames; ++n) {
            parent[n] = random() % n;
            for (auto* each : {&first, &second}) {
                const Eigen::Quaterniond rotation =
                    Eigen::Quaterniond(number(random), number(random), number(random), number(random)).normalized();
                (*each)[n] = {{each == &first ? 0 : kSecond, name(parent[n])},
                              name(n),
                              Eigen::Translation3d(number(random), number(random), number(random)) * rotation};
            }
            tree.add(first[n], n % 3 == 0);
            if (n % 3 != 0) tree.add(second[n], false);
        }
        const RosTime stamp = random() % kSecond;
        const double share = static_cast<double>(stamp) / static_cast<double>(kSecond);
        const auto from_root = [&](std::size_t frame) {
            Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
            for (; frame != 0; frame = parent[frame]) {
                Eigen::Matrix4d step = first[frame].T_parent_child.matrix();
                if (frame % 3 != 0) {
                    const Eigen::Quaterniond begin(first[frame].T_parent_child.linear());
                    const Eigen::Quaterniond end(second[frame].T_parent_child.linear());
                    step.block<3, 3>(0, 0) = begin.slerp(share, end).toRotationMatrix();
                    step.block<3, 1>(0, 3) = (1.0 - share) * first[frame].T_parent_child.translation() +
                                             share * second[frame].T_parent_child.translation();
                }
                T = step * T;
            }
            return T;
        };
        for (std::size_t target = 0; target < kFrames; ++target) {
            for (std::size_t source = 0; source < kFrames; ++source) {
                const Eigen::Matrix4d expected = from_root(target).inverse() * from_root(source);
                EXPECT_LT((found(tree, name(target), name(source), stamp).matrix() - expected).norm(), 1e-9);
            }
        }
    }
}

TEST(FrameTree, FramesThatAreAboveThemselvesHaveNoPoses) {
    FrameTree tree; // two programs publish map -> odom and odom -> map
    tree.add(flat(0, "map", "odom", 1.0), true);
    tree.add(flat(0, "odom", "map", 2.0), true);
    tree.add(flat(0, "odom", "base", 4.0), true);
    tree.add(flat(0, "base", "laser", 0.5), true);
    EXPECT_EQ(found(tree, "base", "laser", 0).translation().x(), 0.5) << "below the loop";
    for (const auto& [target, source] :
         {std::pair("odom", "map"), std::pair("map", "odom"), std::pair("odom", "laser"), std::pair("laser", "map")}) {
        EXPECT_EQ(missing(tree, target, source, 0), NoTransform::kLoop) << target << " " << source;
    }
}

TEST(FrameTree, ForgetsTransformsBeforeTheNewestOnesButTheLast) {
    FrameTree tree;
    tree.forget_before_newest(10 * kSecond);
    for (int n = 0; n <= 100; ++n) tree.add(flat(n * kSecond, "odom", "base", n), false);
    tree.add(flat(0, "base", "laser", 0.5), true);
    EXPECT_EQ(tree.size(), 13U);
    EXPECT_NEAR(found(tree, "odom", "laser", 89 * kSecond + kSecond / 2).translation().x(), 90.0, 1e-12);
    EXPECT_EQ(missing(tree, "odom", "laser", 88 * kSecond), NoTransform::kBefore);
}

TEST(FrameTree, OfARobotThatStandsTheBeginningIsKept) {
    FrameTree tree;
    tree.forget_before_newest(10 * kSecond);
    for (int n = 0; n <= 100; ++n) tree.add(flat(n * kSecond, "odom", "base", 1.0), false);
    tree.add(flat(101 * kSecond, "odom", "base", 2.0), false);
    EXPECT_EQ(found(tree, "odom", "base", 95 * kSecond).translation().x(), 1.0);
}

TEST(FrameTree, ForgetsAllWhenTheClockIsSetBack) {
    FrameTree tree;
    tree.forget_before_newest(10 * kSecond);
    for (const RosTime stamp : {100, 101, 102}) tree.add(flat(stamp * kSecond, "odom", "base", 7.0), false);
    tree.add(flat(102 * kSecond - kSecond / 2, "odom", "base", 7.0), false);
    EXPECT_EQ(found(tree, "odom", "base", 100 * kSecond).translation().x(), 7.0) << "a stamp that jitters";
    tree.add(flat(99 * kSecond, "odom", "base", 1.0), false);
    tree.add(flat(100 * kSecond, "odom", "base", 2.0), false);
    EXPECT_NEAR(found(tree, "odom", "base", 99 * kSecond + kSecond / 2).translation().x(), 1.5, 1e-12);
    EXPECT_EQ(missing(tree, "odom", "base", 101 * kSecond), NoTransform::kAfter);
    EXPECT_EQ(tree.size(), 2U);
}

TEST(FrameTree, TheNumberOfFramesOfOneThatForgetsIsBounded) {
    FrameTree tree;
    tree.forget_before_newest(10 * kSecond);
    for (std::size_t n = 0; n < FrameTree::kFramesMax + 100; ++n) {
        tree.add(flat(0, "odom", "frame" + std::to_string(n), 1.0), false);
    }
    EXPECT_EQ(tree.size(), FrameTree::kFramesMax - 1);
}

} // namespace
} // namespace scanloom::robot
