#include "tests/support/standing_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scanloom::sim {
namespace {

/// Returns an office whose robots start in its north-western rooms only.
World rooms() {
    World office = make_office();
    office.starts = {{-15.0, 4.5, -3.0, 10.0}};
    return office;
}

double apart(const Point2& a, const Point2& b) { return norm(a - b); }

TEST(StandingRobot, StartsInAllowedPlacesWithAClosedDoor) {
    const World office = rooms();
    Random random(1);
    for (const Box& door : doors_of(office)) {
        const World closed = with_door(office, door);
        EXPECT_EQ(closed.solids.size(), office.solids.size() + 1);
        for (int n = 0; n < 20; ++n) {
            const Pose2 place = free_place(closed, random);
            EXPECT_TRUE(office.starts.front().contains({place.x, place.y})) << place.x << ", " << place.y;
            EXPECT_GE(clearance(closed, {place.x, place.y}), 0.3);
        }
    }
}

TEST(StandingRobot, ClosedDoorsBlockTheView) {
    const World office = make_office();
    const Pose2 corridor{-13.6, 3.0, 0.0};
    const Pose2 room{-13.6, 5.0, 0.0};
    EXPECT_TRUE(sees(office, corridor, room));
    EXPECT_FALSE(sees(with_door(office, doors_of(office).front()), corridor, room));
    for (const World& world : {make_room(), make_office(), make_hall()}) {
        for (const Box& door : doors_of(world)) {
            const Point2 middle{0.5 * (door.x_min + door.x_max), 0.5 * (door.y_min + door.y_max)};
            EXPECT_GT(clearance(world, middle), 0.0) << world.name << ": the door must be in free space";
        }
    }
}

TEST(MappedWorld, EachPlaceIsNearAnEarlierOne) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto mapped = mapped_world(make_hall(), 6, seed);
        ASSERT_EQ(mapped.map.size(), 6U);
        std::vector<Point2> places;
        for (const auto& view : mapped.map) places.push_back(view.from);
        places.push_back({mapped.ground_truth.x, mapped.ground_truth.y});
        for (std::size_t n = 1; n < places.size(); ++n) {
            EXPECT_TRUE(std::any_of(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(n),
                                    [&](const Point2& earlier) { return apart(earlier, places[n]) <= 3.0; }))
                << "seed " << seed << ", place " << n;
        }
    }
}

TEST(MappedWorld, ViewsAreInTheWorldFrameAndTheRobotsInItsOwn) {
    const World room = make_room();
    const auto mapped = mapped_world(room, 2, 1);
    const Box bounds = widened(bounds_of(room), 0.1);
    for (const auto& view : mapped.map) {
        EXPECT_GT(view.points.size(), 1000U);
        for (const PointMm& point : view.points) EXPECT_TRUE(bounds.contains(in_metres(point)));
    }
    for (const Point2& point : mapped.seen) EXPECT_TRUE(bounds.contains(transform(mapped.ground_truth, point)));
}

} // namespace
} // namespace scanloom::sim
