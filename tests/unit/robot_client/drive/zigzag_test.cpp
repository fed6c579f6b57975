#include "robot_client/drive/zigzag.hpp"

#include "robot_client/drive/ground_paths.hpp"
#include "robot_client/sim/floor_plan_of.hpp"
#include "tests/unit/robot_client/drive/drawn_plan.hpp"
#include "tests/unit/robot_client/drive/driven.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace scanloom::robot {
namespace {

std::vector<Block> lanes_of(const std::vector<std::string_view>& rows, double spacing) {
    const Ground ground(drawn_plan(rows, 1.0), 0.0);
    return lanes_over(ground, ground.plan().is_free, spacing);
}

std::vector<double> heights(const Block& block) {
    std::vector<double> heights;
    for (const Lane& lane : block) heights.push_back(lane.west.y);
    return heights;
}

TEST(Lanes, AreEvenlySpacedFromTheLowestRowToTheHighest) {
    const auto blocks = lanes_of({"....", "....", "....", "....", "....", "....", "...."}, 4.0);
    ASSERT_EQ(blocks.size(), 1U);
    EXPECT_EQ(heights(blocks[0]), (std::vector{0.5, 3.5, 6.5}));
    for (const Lane& lane : blocks[0]) {
        EXPECT_EQ(lane.west.x, 0.5);
        EXPECT_EQ(lane.east.x, 3.5);
    }
}

TEST(Lanes, SomethingInTheMiddleMakesFourBlocks) {
    const auto blocks = lanes_of({".......", //
                                  ".......", //
                                  "..###..", //
                                  "..###..", //
                                  ".......", //
                                  "......."},
                                 1.0);
    ASSERT_EQ(blocks.size(), 4U);
    EXPECT_EQ(heights(blocks[0]), (std::vector{0.5, 1.5})) << "below";
    EXPECT_EQ(heights(blocks[1]), (std::vector{2.5, 3.5})) << "on the left";
    EXPECT_EQ(blocks[1][0].east.x, 1.5);
    EXPECT_EQ(heights(blocks[2]), (std::vector{2.5, 3.5})) << "on the right";
    EXPECT_EQ(heights(blocks[3]), (std::vector{4.5, 5.5})) << "above";
}

TEST(Lanes, OneBlockDoesNotSweepTheBorderAgainThatAnotherSweeps) {
    const auto blocks = lanes_of({".......", //
                                  "..###..", //
                                  "..###..", //
                                  "..###..", //
                                  "......."},
                                 2.0);
    ASSERT_EQ(blocks.size(), 4U);
    EXPECT_EQ(heights(blocks[0]), std::vector{0.5});
    EXPECT_EQ(heights(blocks[1]), std::vector{2.5}) << "two rows from the lanes below and above";
    EXPECT_EQ(heights(blocks[3]), std::vector{4.5});
}

TEST(Lanes, AnOutlineThatOnlyBulgesMakesNoNewBlock) {
    EXPECT_EQ(lanes_of({"....", "###.", "##..", "...."}, 1.0).size(), 1U);
}

/// A zigzag over the plan of `known`, in a world that may be another.
struct Swept {
    Swept(const World& known, World world, const Pose2& start = {-2.0, -2.0, 0.0})
        : Swept(std::make_unique<Zigzag>(floor_plan_of(truth_of(known, 0.05))), std::move(world), start) {}
    Swept(std::unique_ptr<Zigzag> made, World world, const Pose2& start)
        : zigzag(made.get()), driven(std::move(world), start, std::move(made)) {}

    const Zigzag* zigzag; // the simulator has it
    Driven driven;
};

TEST(Zigzag, SweepsARoomWithFurniture) {
    const World room = walled({{-0.5, -0.5, 0.7, 0.6}, {2.4, -3.0, 3.0, -1.0}});
    Swept swept(room, room);
    ASSERT_TRUE(swept.driven.run(1200.0));
    EXPECT_GT(swept.zigzag->coverage(), 0.95);
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_EQ(swept.zigzag->detours(), 0);
    EXPECT_EQ(swept.zigzag->lanes_given_up(), 0);
    EXPECT_NE(swept.zigzag->remarks().find(" m2 within reach, in "), std::string::npos) << swept.zigzag->remarks();
}

TEST(Zigzag, GoesAroundWhatThePlanDoesNotKnowAndBackToItsLane) {
    Swept swept(walled({}), walled({{0.5, -0.3, 1.1, 0.3}}));
    ASSERT_TRUE(swept.driven.run(1200.0));
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_GE(swept.zigzag->detours(), 2) << "several lanes lead through it";
    EXPECT_EQ(swept.zigzag->lanes_given_up(), 0);
    EXPECT_GT(swept.zigzag->coverage(), 0.9);
    for (const Point2& behind : {Point2{1.6, 0.0}, Point2{0.0, 0.0}}) EXPECT_LT(swept.driven.nearest_to(behind), 0.15);
}

TEST(Zigzag, ADetourIsAStepAsideAWayPastAndAWayBack) {
    Swept swept(walled({}), walled({{0.5, -0.3, 1.1, 0.3}}));
    swept.driven.run(1200.0);
    // past it, beside lanes that lead along x: at least its length, at one distance from it
    const auto beside = std::ranges::count_if(swept.driven.way(), [](const Point2& place) {
        return place.x > 0.5 && place.x < 1.1 && std::abs(std::abs(place.y) - 0.3 - 0.27) < 0.04;
    });
    EXPECT_GT(beside, 10);
}

TEST(Zigzag, GivesUpALaneThatIsShutAndGoesOn) {
    // a wall from side to side that the plan does not know: all beyond cannot be reached
    Swept swept(walled({}), walled({{-3.0, 0.5, 3.0, 0.7}}));
    ASSERT_TRUE(swept.driven.run(3600.0)) << "bounded";
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_GT(swept.zigzag->lanes_given_up(), 3);
    EXPECT_GT(swept.zigzag->coverage(), 0.5);
    EXPECT_LT(swept.zigzag->coverage(), 0.65);
    EXPECT_NE(swept.zigzag->remarks().find("lanes given up"), std::string::npos);
}

TEST(Zigzag, WaitsForAPersonWhoPasses) {
    World world = walled({});
    world.walkers = {{.loop = {{-2.0, 1.0}, {2.0, 1.0}, {2.0, -1.0}, {-2.0, -1.0}}}};
    Swept swept(walled({}), world);
    ASSERT_TRUE(swept.driven.run(1800.0));
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_GT(swept.zigzag->coverage(), 0.9);
}

} // namespace
} // namespace scanloom::robot
