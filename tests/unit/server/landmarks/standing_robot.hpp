#pragma once

#include "robot_client/sim/laser.hpp"
#include "robot_client/sim/ray_casting.hpp"
#include "robot_client/sim/world.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

/// What a robot sees that stands still, in simulated worlds.
namespace scanloom::testing_support {

/// The points of some turns of a lidar, in the robot's frame.
inline std::vector<Point2> standing_capture(const robot::World& world, const Pose2& place, int turns,
                                            robot::Random& random) {
    const Sensor laser = robot::find_laser("lidar360").value();
    std::vector<Point2> points;
    for (int turn = 0; turn < turns; ++turn) {
        const auto ranges = robot::sweep(world, laser, place, robot::Noise{}, random);
        for (std::size_t n = 0; n < ranges.size(); ++n) {
            if (ranges[n] == kInvalidRange || ranges[n] == kNoReturn) continue;
            const double angle = beam_angle(laser.angles, n);
            points.push_back(1e-3 * ranges[n] * Point2(std::cos(angle), std::sin(angle)));
        }
    }
    return points;
}

/// A robot was in two places of a world between which a door moved.
struct TwoCaptures {
    std::vector<Point2> first;
    std::vector<Point2> second;
    Pose2 T_first_second;
};

inline robot::World with_door(const robot::World& world, const robot::Box& door) {
    auto solids = world.solids;
    solids.push_back(door);
    return robot::make_world(world.name, std::move(solids), world.floors);
}

/// A free place within the world's bounds.
inline Pose2 free_place(const robot::World& world, robot::Random& random) {
    constexpr double kClearance = 0.3;
    for (;;) {
        const auto& floor = world.starts[random.index(world.starts.size())];
        const Point2 place(random.uniform(floor.x_min, floor.x_max), random.uniform(floor.y_min, floor.y_max));
        if (robot::clearance(world, place) < kClearance) continue;
        return {place.x(), place.y(), random.uniform(-std::numbers::pi, std::numbers::pi)};
    }
}

inline bool sees(const robot::World& world, const Pose2& from, const Pose2& to) {
    const double distance = std::hypot(to.x - from.x, to.y - from.y);
    const double yaw = std::atan2(to.y - from.y, to.x - from.x);
    return world.obstacles->cast_ray({from.x, from.y}, yaw, distance + 0.3) > distance + 0.2;
}

/// Two places 0.5 to 2 m apart in any directions, each in sight of the other, with the door open in one of them.
inline TwoCaptures two_captures(const robot::World& open, const std::vector<robot::Box>& doors, std::uint64_t seed,
                                int turns = 20) {
    robot::Random random(seed);
    const robot::World closed = doors.empty() ? open : with_door(open, doors[random.index(doors.size())]);
    for (;;) {
        const Pose2 first = free_place(closed, random);
        const double bearing = random.uniform(-std::numbers::pi, std::numbers::pi);
        const double distance = random.uniform(0.5, 2.0);
        const Pose2 second{first.x + distance * std::cos(bearing), first.y + distance * std::sin(bearing),
                           random.uniform(-std::numbers::pi, std::numbers::pi)};
        if (robot::clearance(closed, {second.x, second.y}) < 0.3 || !sees(closed, first, second)) continue;
        const bool closes = random.index(2) == 0;
        auto before = standing_capture(closes ? open : closed, first, turns, random);
        auto after = standing_capture(closes ? closed : open, second, turns, random);
        return {std::move(before), std::move(after), compose(inverse(first), second)};
    }
}

/// Where doors may stand: shut in the office's doorways and at the hall's cabin, ajar along the room's walls.
inline std::vector<robot::Box> doors_of(const robot::World& world) {
    std::vector<robot::Box> doors;
    if (world.name == "office") {
        for (const double x : {-13.6, -7.6, -1.6, 4.4, 10.4}) doors.push_back({x - 0.6, 3.97, x + 0.6, 4.03});
        for (const double x : {-10.4, -4.4, 1.6, 7.6, 13.6}) doors.push_back({x - 0.6, -4.03, x + 0.6, -3.97});
        for (const double x : {-7.0, 0.0, 7.0}) doors.push_back({x - 0.6, 1.97, x + 0.6, 2.03});
    } else if (world.name == "hall") {
        doors = {{0.4, 15.05, 1.6, 15.1}, {-10.0, 4.0, -9.95, 5.2}, {23.9, 9.1, 23.95, 10.3}};
    } else {
        doors = {{-4.0, 3.9, -3.95, 5.0}, {3.9, 2.5, 5.0, 2.55}, {3.0, -5.0, 3.05, -3.9}, {-5.0, -2.0, -3.9, -1.95}};
    }
    return doors;
}

} // namespace scanloom::testing_support
