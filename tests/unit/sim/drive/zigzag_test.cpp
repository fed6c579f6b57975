#include "sim/drive/zigzag.hpp"

#include "sim/drive/ground.hpp"
#include "sim/ground_truth.hpp"
#include "tests/unit/sim/drive/drawn_plan.hpp"
#include "tests/unit/sim/drive/driven.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>

namespace scanloom::sim {
namespace {

std::vector<Block> lanes_of(const std::vector<std::string_view>& rows, double spacing) {
    const Ground ground(drawn_plan(rows, 1.0), 0.0);
    return lanes_over(ground, ground.free(), spacing);
}

std::vector<double> heights(const Block& block) {
    std::vector<double> heights;
    for (const Lane& lane : block) heights.push_back(lane.west.y);
    return heights;
}

TEST(Lanes, AreEvenlySpacedFromTheLowestToTheHighestRow) {
    const auto blocks = lanes_of({"....", "....", "....", "....", "....", "....", "...."}, 4.0);
    ASSERT_EQ(blocks.size(), 1U);
    EXPECT_EQ(heights(blocks[0]), (std::vector{0.5, 3.5, 6.5}));
    for (const Lane& lane : blocks[0]) {
        EXPECT_EQ(lane.west.x, 0.5);
        EXPECT_EQ(lane.east.x, 3.5);
    }
}

TEST(Lanes, ObjectInTheMiddleGivesFourBlocks) {
    const auto blocks = lanes_of({".......", //
                                  ".......", //
                                  "..###..", //
                                  "..###..", //
                                  ".......", //
                                  "......."},
                                 1.0);
    ASSERT_EQ(blocks.size(), 4U);
    EXPECT_EQ(heights(blocks[0]), (std::vector{0.5, 1.5})) << "the block below the object";
    EXPECT_EQ(heights(blocks[1]), (std::vector{2.5, 3.5})) << "the block on the left";
    EXPECT_EQ(blocks[1][0].east.x, 1.5);
    EXPECT_EQ(heights(blocks[2]), (std::vector{2.5, 3.5})) << "the block on the right";
    EXPECT_EQ(heights(blocks[3]), (std::vector{4.5, 5.5})) << "the block above the object";
}

TEST(Lanes, BlocksDoNotRepeatTheBordersOfOthers) {
    const auto blocks = lanes_of({".......", //
                                  "..###..", //
                                  "..###..", //
                                  "..###..", //
                                  "......."},
                                 2.0);
    ASSERT_EQ(blocks.size(), 4U);
    EXPECT_EQ(heights(blocks[0]), std::vector{0.5});
    EXPECT_EQ(heights(blocks[1]), std::vector{2.5}) << "the lane is two rows from those below and above";
    EXPECT_EQ(heights(blocks[3]), std::vector{4.5});
}

TEST(Lanes, BulgingOutlineGivesNoNewBlock) { EXPECT_EQ(lanes_of({"....", "###.", "##..", "...."}, 1.0).size(), 1U); }

/// A zigzag over the plan of `known`, driven in a world that may differ.
struct Swept {
    Swept(const World& known, World world, const Pose2& start = {-2.0, -2.0, 0.0})
        : Swept(std::make_unique<Zigzag>(floor_plan_of(ground_truth_of(known, 0.05))), std::move(world), start) {}
    Swept(std::unique_ptr<Zigzag> made, World world, const Pose2& start)
        : zigzag(made.get()), driven(std::move(world), start, std::move(made)) {}

    /// Returns the number before `what` in the remarks, or 0.
    [[nodiscard]] int count_of(const std::string& what) const {
        std::smatch found;
        const std::string remarks = zigzag->remarks();
        return std::regex_search(remarks, found, std::regex("(\\d+) " + what)) ? std::stoi(found[1]) : 0;
    }

    const Zigzag* zigzag; // owned by the simulator
    Driven driven;
};

TEST(Zigzag, CoversARoomWithFurniture) {
    const World room = walled({{-0.5, -0.5, 0.7, 0.6}, {2.4, -3.0, 3.0, -1.0}});
    Swept swept(room, room);
    ASSERT_TRUE(swept.driven.run(1200.0));
    EXPECT_GT(swept.zigzag->coverage(), 0.95);
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_EQ(swept.count_of("detours"), 0);
    EXPECT_EQ(swept.count_of("lanes abandoned"), 0);
    EXPECT_NE(swept.zigzag->remarks().find(" reachable m2, in "), std::string::npos) << swept.zigzag->remarks();
}

TEST(Zigzag, DetoursAroundAnUnknownObstacleAndReturnsToTheLane) {
    Swept swept(walled({}), walled({{0.5, -0.3, 1.1, 0.3}}));
    ASSERT_TRUE(swept.driven.run(1200.0));
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_GE(swept.count_of("detours"), 2) << "several lanes cross the obstacle";
    EXPECT_EQ(swept.count_of("lanes abandoned"), 0);
    EXPECT_GT(swept.zigzag->coverage(), 0.9);
    for (const Point2& behind : {Point2{1.6, 0.0}, Point2{0.0, 0.0}}) EXPECT_LT(swept.driven.nearest_to(behind), 0.15);
}

TEST(Zigzag, DetourPassesTheObstacleAtAConstantDistance) {
    Swept swept(walled({}), walled({{0.5, -0.3, 1.1, 0.3}}));
    swept.driven.run(1200.0);
    // Next to the obstacle, along lanes parallel to x: the robot passes its length at a constant distance.
    const auto passing = std::ranges::count_if(swept.driven.trajectory(), [](const Point2& place) {
        return place.x > 0.5 && place.x < 1.1 && std::abs(std::abs(place.y) - 0.3 - 0.27) < 0.04;
    });
    EXPECT_GT(passing, 10);
}

TEST(Zigzag, GivesUpABlockedLaneAndContinues) {
    // The plan does not contain a wall from side to side: the area beyond it is unreachable.
    Swept swept(walled({}), walled({{-3.0, 0.5, 3.0, 0.7}}));
    ASSERT_TRUE(swept.driven.run(3600.0)) << "the run must end";
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_GT(swept.count_of("lanes abandoned"), 3);
    EXPECT_GT(swept.zigzag->coverage(), 0.5);
    EXPECT_LT(swept.zigzag->coverage(), 0.65);
    EXPECT_NE(swept.zigzag->remarks().find("lanes abandoned"), std::string::npos);
}

TEST(Zigzag, WaitsForAPassingPerson) {
    World world = walled({});
    world.walkers = {{.loop = {{-2.0, 1.0}, {2.0, 1.0}, {2.0, -1.0}, {-2.0, -1.0}}}};
    Swept swept(walled({}), world);
    ASSERT_TRUE(swept.driven.run(1800.0));
    EXPECT_EQ(swept.driven.simulator().collisions(), 0U);
    EXPECT_GT(swept.zigzag->coverage(), 0.9);
}

} // namespace
} // namespace scanloom::sim
