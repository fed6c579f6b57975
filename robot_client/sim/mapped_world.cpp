#include "robot_client/sim/mapped_world.hpp"

#include "robot_client/sim/standing_robot.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::robot {

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
    MappedWorld mapped{.map = {}, .seen = {}, .truth = stands.back()};
    stands.pop_back();
    bool is_open = true;
    for (const Pose2& stand : stands) {
        mapped.map.push_back(standing_view(is_open ? open : closed, stand, random));
        is_open = !is_open;
    }
    mapped.seen = standing_capture(random.index(2) == 0 ? open : closed, mapped.truth, kMappedTurns, random);
    return mapped;
}

} // namespace scanloom::robot
