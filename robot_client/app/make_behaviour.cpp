#include "robot_client/app/make_behaviour.hpp"

#include "robot_client/app/waypoint_list.hpp"
#include "robot_client/drive/body.hpp"
#include "robot_client/drive/wall_follower.hpp"
#include "robot_client/drive/waypoints.hpp"
#include "robot_client/drive/zigzag.hpp"
#include "robot_client/sim/floor_plan_of.hpp"
#include "robot_client/sim/tour.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::robot {
namespace {

constexpr double kPlanCellSize = 0.05; // metres

/// Returns why a robot cannot be at a place, whatever its path.
std::string unreachable(const World& world, const Point2& place) {
    if (!bounds_of(world).contains(place)) return "outside the world";
    if (world.obstacles->contain(place)) return "inside an obstacle";
    if (world.obstacles->distance(place) < kBodyRadius) return "too close to an obstacle";
    return {};
}

Result<NamedBehaviour> make_waypoints(const SimulateOptions& simulate, const World& world) {
    const bool is_tour = simulate.waypoints.empty();
    auto waypoints = is_tour ? Result<std::vector<Point2>>(tour_of(world.name)) : read_waypoints(simulate.waypoints);
    if (!waypoints) return waypoints.error();
    if (waypoints->empty()) {
        return Error{Errc::kInvalidField, fmt::format("the world {} has no tour; give --waypoints", simulate.world)};
    }
    std::string name = fmt::format("{} {}", is_tour ? "tour" : "waypoints", to_text(*waypoints));
    return NamedBehaviour{
        std::make_unique<Waypoints>(std::move(*waypoints), is_tour ? TourStart::kNearest : TourStart::kFirst,
                                    [world](const Point2& place) { return unreachable(world, place); }),
        std::move(name)};
}

} // namespace

Result<NamedBehaviour> make_behaviour(const SimulateOptions& simulate, const World& world) {
    if (simulate.drive == "waypoints") return make_waypoints(simulate, world);
    if (simulate.drive == "zigzag") {
        return NamedBehaviour{std::make_unique<Zigzag>(floor_plan_of(truth_of(world, kPlanCellSize))), simulate.drive};
    }
    return NamedBehaviour{std::make_unique<WallFollower>(), simulate.drive};
}

} // namespace scanloom::robot
