#include "lab/door_room.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scanloom::lab {
namespace {

double look(const sim::World& world, double x, double y, double yaw) {
    return world.obstacles->cast_ray({x, y}, yaw, 20.0);
}

TEST(DoorRoom, ClosedDoorBlocksTheViewAndOpenDoorShowsTheLobby) {
    EXPECT_NEAR(look(make_door_room(Door::kClosed), 3.0, 2.7, 0.0), 2.08, 1e-9) << "the closed door leaf";
    EXPECT_NEAR(look(make_door_room(Door::kOpen), 3.0, 2.7, 0.0), 4.2, 1e-9) << "the lobby's wall";
    EXPECT_NEAR(look(make_door_room(Door::kOpen), 4.5, 2.7, std::numbers::pi / 2.0), 0.5, 1e-9) << "the open door leaf";
    EXPECT_NEAR(look(make_door_room(Door::kClosed), 4.5, 2.7, std::numbers::pi / 2.0), 2.3, 1e-9) << "the room's wall";
}

TEST(DoorRoom, EqualsTheSimulatorsRoomExceptForTheDoor) {
    const auto room = sim::make_room();
    const auto closed = make_door_room(Door::kClosed);
    for (int degree = 0; degree < 360; ++degree) {
        const double yaw = degree * std::numbers::pi / 180.0;
        const double expected = look(room, -3.3, -3.3, yaw);
        const Point2 end = Point2{-3.3, -3.3} + expected * Point2{std::cos(yaw), std::sin(yaw)};
        if (std::abs(end.x - 5.0) < 1e-6 && end.y > 2.1 && end.y < 3.3) continue;
        EXPECT_NEAR(look(closed, -3.3, -3.3, yaw), expected, 1e-9) << degree;
    }
}

TEST(DoorRoom, PlacesAreFreeAndSeeTheDoorAndTheSecondPlace) {
    const auto world = make_door_room(Door::kOpen);
    const auto sees = [&](const Pose2& from, const Point2& to) {
        const Point2 ray = to - Point2{from.x, from.y};
        return look(world, from.x, from.y, std::atan2(ray.y, ray.x)) >= norm(ray) - 1e-6;
    };
    const Pose2& second = kDoorRoomPlaces[1];
    for (const Pose2& place : kDoorRoomPlaces) {
        EXPECT_GT(sim::clearance(world, {place.x, place.y}), 0.3) << place.x;
        EXPECT_TRUE(sees(place, {second.x, second.y})) << place.x;
        EXPECT_TRUE(sees(place, {5.08, 2.7})) << place.x;
    }
}

} // namespace
} // namespace scanloom::lab
