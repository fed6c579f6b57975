#include "tests/support/standing_robot.hpp"

#include "sim/range_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::sim {
namespace {

constexpr double kClearance = 0.3; // metres

double any_direction(Random& random) { return random.uniform(-std::numbers::pi, std::numbers::pi); }

} // namespace

std::vector<Point2> standing_capture(const World& world, const Pose2& place, int turns, Random& random) {
    const Sensor laser = find_laser("lidar360").value();
    std::vector<Point2> points;
    for (int turn = 0; turn < turns; ++turn) {
        const auto ranges = sweep(world, laser, place, Noise{}, random);
        for (std::size_t n = 0; n < ranges.size(); ++n) {
            if (ranges[n] == kInvalidRange || ranges[n] == kNoReturn) continue;
            const double angle = beam_angle(laser.angles, n);
            points.push_back(1e-3 * ranges[n] * Point2{std::cos(angle), std::sin(angle)});
        }
    }
    return points;
}

std::vector<Box> doors_of(const World& world) {
    std::vector<Box> doors;
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

World with_door(const World& world, const Box& door) {
    auto solids = world.solids;
    solids.push_back(door);
    World closed = make_world(world.name, std::move(solids), world.floors);
    closed.starts = world.starts;
    return closed;
}

Pose2 free_place(const World& world, Random& random) {
    for (;;) {
        const Box& start = world.starts[random.index(world.starts.size())];
        const double y = random.uniform(start.y_min, start.y_max); // y first: recorded results depend on the order
        const double x = random.uniform(start.x_min, start.x_max);
        const Point2 place{x, y};
        if (clearance(world, place) < kClearance) continue;
        return {place.x, place.y, any_direction(random)};
    }
}

bool sees(const World& world, const Pose2& from, const Pose2& to) {
    const double distance = std::hypot(to.x - from.x, to.y - from.y);
    const double yaw = std::atan2(to.y - from.y, to.x - from.x);
    return world.obstacles->cast_ray({from.x, from.y}, yaw, distance + 0.3) > distance + 0.2;
}

StandingView standing_view(const World& world, const Pose2& place, Random& random, int turns) {
    StandingView view{{place.x, place.y}, {}};
    for (const Point2& point : standing_capture(world, place, turns, random)) {
        view.points.push_back(in_millimetres(transform(place, point)));
    }
    return view;
}

MappedWorld mapped_world(const World& open, int places, std::uint64_t seed, double apart_max) {
    Random random(seed);
    const auto doors = doors_of(open);
    const World closed = with_door(open, doors[random.index(doors.size())]);
    std::vector<Pose2> stands = {free_place(closed, random)};
    while (static_cast<int>(stands.size()) < places + 1) {
        const Pose2 next = free_place(closed, random);
        const bool is_near = std::ranges::any_of(stands, [&](const Pose2& stand) {
            return std::hypot(next.x - stand.x, next.y - stand.y) <= apart_max && sees(closed, stand, next);
        });
        if (is_near) stands.push_back(next);
    }
    MappedWorld mapped{.map = {}, .seen = {}, .ground_truth = stands.back()};
    stands.pop_back();
    bool is_open = true;
    for (const Pose2& stand : stands) {
        mapped.map.push_back(standing_view(is_open ? open : closed, stand, random));
        is_open = !is_open;
    }
    mapped.seen = standing_capture(random.index(2) == 0 ? open : closed, mapped.ground_truth, kMappedTurns, random);
    return mapped;
}

} // namespace scanloom::sim
