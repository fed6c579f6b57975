#include "robot_client/app/make_behaviour.hpp"

#include "robot_client/app/waypoint_list.hpp"
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

Result<NamedBehaviour> make_waypoints(const SimulateOptions& simulate, const World& world) {
    const bool is_tour = simulate.waypoints.empty();
    auto waypoints = is_tour ? Result<std::vector<Point2>>(tour_of(world.name)) : read_waypoints(simulate.waypoints);
    if (!waypoints) return waypoints.error();
    if (waypoints->empty()) {
        return Error{Errc::kInvalidField,
                     fmt::format("no tour of the world {} is known; say where to drive: --waypoints", simulate.world)};
    }
    std::string name = fmt::format("{} {}", is_tour ? "tour" : "waypoints", to_text(*waypoints));
    return NamedBehaviour{
        std::make_unique<Waypoints>(std::move(*waypoints), is_tour ? TourStart::kNearest : TourStart::kFirst),
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
