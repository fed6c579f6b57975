#include "core/landmarks/reference_map.hpp"
#include "tests/support/located_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::landmarks {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using namespace testing_support;

constexpr std::size_t kView = ReferenceLayer::kViewItself;

RobotCapture capture_at(const Pose2& pose, Revision ended, std::size_t points = 3) {
    return {.robot = 0,
            .capture = {.pose = pose, .points = std::vector<PointMm>(points), .from = {pose.x, pose.y}},
            .ended = ended};
}

std::vector<Revision> kept_in(const ReferenceLayer& layer) {
    std::vector<Revision> ended;
    for (const auto& view : layer.snapshot()) ended.push_back(view->ended);
    return ended;
}

TEST(ReferenceLayer, KeepsTheNewestTwoViewsOfAPlace) {
    ReferenceLayer layer;
    for (Revision n = 1; n <= 5; ++n) layer.add(capture_at({0.1, 0.2, 0.3}, n, 10 * n));
    EXPECT_THAT(kept_in(layer), ElementsAre(4, 5));
    EXPECT_EQ(layer.size(), 90U + 2 * kView);
    layer.add(capture_at({0.6, 0.2, 0.3}, 6));
    layer.add(capture_at({-0.1, 0.2, 0.3}, 7));
    layer.add(capture_at({0.1, -0.2, 0.3}, 8));
    EXPECT_THAT(kept_in(layer), ElementsAre(4, 5, 6, 7, 8));
}

TEST(ReferenceLayer, KeepsEveryDirectionOfAForwardLaser) {
    ReferenceLayer layer;
    for (int n = 0; n < 8; ++n) layer.add(capture_at({0.1, 0.1, -3.0 + 0.785 * n}, static_cast<Revision>(n) + 1));
    EXPECT_THAT(kept_in(layer), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
    layer.add(capture_at({0.1, 0.1, 3.14159265}, 9)); // just before the turn ends
    layer.add(capture_at({0.1, 0.1, -3.14159265}, 10));
    EXPECT_EQ(layer.snapshot().size(), 10U);
}

TEST(ReferenceLayer, ThinsViewsWithManyPoints) {
    ReferenceLayer layer;
    layer.add(capture_at({0.1, 0.2, 0.3}, 1, 4096));
    EXPECT_EQ(layer.size(), kView + 4096U);
    layer.add(capture_at({5.1, 0.2, 0.3}, 2, 4097));
    EXPECT_EQ(layer.size(), 2 * kView + 4096U + 2049U);
    layer.add(capture_at({9.1, 0.2, 0.3}, 3, 65'536));
    EXPECT_EQ(layer.size(), 3 * kView + 4096U + 2049U + 4096U);
}

TEST(ReferenceLayer, IgnoresViewsWithoutPoints) {
    ReferenceLayer layer;
    layer.add(capture_at({0.1, 0.2, 0.3}, 1, 0));
    EXPECT_THAT(layer.snapshot(), IsEmpty());
    EXPECT_EQ(layer.size(), 0U);
}

/// A room with a box in its middle that is present in the first view only.
class ReferenceMapTest : public testing::Test {
protected:
    ReferenceMapTest() {
        sim::Random random(1);
        const auto add = [&](const sim::World& world, const Pose2& place) {
            views_.push_back(reference_view(world, place, random));
        };
        add(boxed_, {-2.0, 0.0, 0.0});
        add(empty_, {2.0, 0.5, 1.0});
        add(empty_, {-1.5, -1.0, 2.0});
        add(empty_, {0.5, 2.0, 2.0});
    }

    static sim::World room(const std::vector<sim::Box>& things) {
        std::vector<sim::Box> solids = {
            {-4.0, -4.0, 4.0, -3.0}, {-4.0, 3.0, 4.0, 4.0}, {-4.0, -4.0, -3.0, 4.0}, {3.0, -4.0, 4.0, 4.0}};
        solids.insert(solids.end(), things.begin(), things.end());
        return sim::make_world("room", std::move(solids), {{-3.0, -3.0, 3.0, 3.0}});
    }

    /// Returns a map whose origin is at an arbitrary place, because the result must not depend on it.
    static ReferenceMap map_of(const ReferenceViews& views) { return ReferenceMap::of(views, {0.5, -0.25}).value(); }

    [[nodiscard]] static bool has_surface_at(const ReferenceMap& map, const Point2& place) {
        return std::ranges::any_of(
            map.surfels(), [&](const Surfel& surfel) { return norm(surfel.position + map.middle() - place) < 0.15; });
    }

    const sim::World empty_ = room({});
    const sim::World boxed_ = room({{-0.2, -0.2, 0.2, 0.2}});
    ReferenceViews views_;
};

TEST_F(ReferenceMapTest, RemovesSurfacesThatMostViewsContradict) {
    const auto then = map_of({views_.front()});
    EXPECT_TRUE(has_surface_at(then, {-0.2, 0.0}));
    const auto now = map_of(views_);
    EXPECT_FALSE(has_surface_at(now, {-0.2, 0.0}));
    EXPECT_TRUE(has_surface_at(now, {-3.0, 0.0}));
    EXPECT_TRUE(has_surface_at(now, {3.0, 0.3}));
}

TEST_F(ReferenceMapTest, StopsWhenTheCallbackReturnsAnError) {
    int total_calls = 0;
    const auto map = ReferenceMap::of(views_, {0.0, 0.0}, [&] { return ++total_calls, Result<>(); });
    ASSERT_TRUE(map);
    ASSERT_GE(total_calls, static_cast<int>(views_.size() + map->surfels().size()));
    for (const int last : {1, static_cast<int>(views_.size()) + 1, total_calls}) {
        int calls = 0;
        const auto stop_at_last = [&]() -> Result<> {
            return ++calls < last ? Result<>() : Error{Errc::kShuttingDown, "the server is shutting down"};
        };
        EXPECT_FALSE(ReferenceMap::of(views_, {0.0, 0.0}, stop_at_last)) << last << " of " << total_calls;
        EXPECT_EQ(calls, last);
    }
}

TEST_F(ReferenceMapTest, ExtentIsASquareAroundAllPoints) {
    const auto extent = extent_of(views_);
    ASSERT_TRUE(extent);
    EXPECT_NEAR(extent->half, 3.0, 0.1);
    EXPECT_NEAR(norm(extent->middle), 0.0, 0.1);
    EXPECT_FALSE(extent_of({}));
}

TEST_F(ReferenceMapTest, SensorIsPossibleInObservedFreeSpaceOnly) {
    const auto map = map_of(views_);
    const auto possible = [&](double x, double y) { return map.is_possible(Point2{x, y} - map.middle()); };
    EXPECT_TRUE(possible(1.0, -1.0));
    EXPECT_TRUE(possible(-2.0, 0.0)) << "a robot has been there";
    EXPECT_FALSE(possible(-3.5, 0.0));
    EXPECT_FALSE(possible(0.0, 5.0));
    EXPECT_FALSE(map_of({}).is_possible({0.0, 0.0}));
}

TEST_F(ReferenceMapTest, AroundReturnsNearbySurfelsAndTheirHorizons) {
    const auto map = map_of(views_);
    const Point2 corner = Point2{-3.0, -3.0} - map.middle();
    const auto seen = map.around(corner, 1.0);
    EXPECT_FALSE(seen.surface.surfels().empty());
    for (const Surfel& surfel : seen.surface.surfels()) EXPECT_LE(norm(surfel.position - corner), 1.0);
    EXPECT_EQ(seen.horizons.size(), 4U);
    EXPECT_TRUE(map.around(corner + Point2{-50.0, 0.0}, 1.0).horizons.empty());
}

} // namespace
} // namespace scanloom::landmarks
