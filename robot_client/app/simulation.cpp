#include "robot_client/app/simulation.hpp"

#include "robot_client/app/waypoint_list.hpp"
#include "sim/drive/behaviour.hpp"
#include "sim/drive/wall_follower.hpp"
#include "sim/drive/waypoints.hpp"
#include "sim/drive/zigzag.hpp"
#include "sim/ground_truth.hpp"
#include "sim/robot/exploring_source.hpp"
#include "sim/robot/simulated_source.hpp"
#include "sim/robot/world_file.hpp"
#include "sim/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace scanloom::robot {
namespace {

constexpr double kPlanCellSize = 0.05; // metres

/// Returns why a robot cannot be at a place, whatever its path.
std::string unreachable(const sim::World& world, const Point2& place) {
    if (!bounds_of(world).contains(place)) return "outside the world";
    if (world.obstacles->contain(place)) return "inside an obstacle";
    if (world.obstacles->distance(place) < sim::kBodyRadius) return "too close to an obstacle";
    return {};
}

Result<NamedBehaviour> make_waypoints(const SimulateOptions& simulate, const sim::World& world) {
    const bool is_tour = simulate.waypoints.empty();
    auto waypoints =
        is_tour ? Result<std::vector<Point2>>(sim::tour_of(world.name)) : read_waypoints(simulate.waypoints);
    if (!waypoints) return waypoints.error();
    if (waypoints->empty()) {
        return Error{Errc::kInvalidField, fmt::format("the world {} has no tour; give --waypoints", simulate.world)};
    }
    std::string name = fmt::format("{} {}", is_tour ? "tour" : "waypoints", to_text(*waypoints));
    return NamedBehaviour{std::make_unique<sim::Waypoints>(
                              std::move(*waypoints), is_tour ? sim::TourStart::kNearest : sim::TourStart::kFirst,
                              [world](const Point2& place) { return unreachable(world, place); }),
                          std::move(name)};
}

} // namespace

Result<NamedBehaviour> make_behaviour(const SimulateOptions& simulate, const sim::World& world) {
    if (simulate.drive == "waypoints") return make_waypoints(simulate, world);
    if (simulate.drive == "zigzag") {
        return NamedBehaviour{std::make_unique<sim::Zigzag>(floor_plan_of(ground_truth_of(world, kPlanCellSize))),
                              "zigzag 2"};
    }
    return NamedBehaviour{std::make_unique<sim::WallFollower>(), simulate.drive};
}

namespace {

Result<> check_range(const Sensor& sensor) {
    if (sensor.range_max > sensor.range_min) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("--max-range is {} m, but the {} {} has a minimum range of {} m", sensor.range_max,
                             sensor.kind == SensorKind::kLaser ? "laser" : "sonar", sensor.name, sensor.range_min)};
}

/// Errors: unknown names, and a range that leaves a sensor nothing to measure.
Result<> choose_sensors(const RobotOptions& options, const SimulateOptions& simulate,
                        sim::SimulatorOptions& simulator) {
    if (simulate.laser != "none") {
        auto laser = sim::find_laser(simulate.laser);
        if (!laser) return laser.error();
        if (options.range_max) laser->range_max = *options.range_max;
        if (auto ok = check_range(*laser); !ok) return ok.error();
        simulator.laser = std::move(*laser);
    }
    if (simulate.sonar != "none") {
        auto sonar = sim::find_sonar(simulate.sonar);
        if (!sonar) return sonar.error();
        sonar->range_max = std::min(sonar->range_max, options.range_max.value_or(sonar->range_max));
        if (auto ok = check_range(*sonar); !ok) return ok.error();
        simulator.sonar = std::move(*sonar);
    }
    return {};
}

std::optional<sim::Noise> noise_of(const SimulateOptions& simulate) {
    constexpr sim::Noise kOfOdometryOnly{.range = 0.0, .beam_angle = 0.0};
    const double odometry = simulate.odometry_noise.value_or(simulate.noise == "none" ? 0.0 : 1.0);
    if (simulate.noise == "gaussian") return sim::with_odometry({}, odometry);
    if (simulate.noise == "uniform") {
        sim::Noise noise = kOfOdometryOnly;
        noise.range_uniform = simulate.noise_width.value_or(kNoiseWidth);
        return sim::with_odometry(noise, odometry);
    }
    if (odometry > 0.0) return sim::with_odometry(kOfOdometryOnly, odometry);
    return std::nullopt;
}

Result<sim::SimulatorOptions> make_options(const RobotOptions& options, const SimulateOptions& simulate) {
    auto world = sim::load_world(simulate.world);
    if (!world) return world.error();
    sim::SimulatorOptions simulator;
    simulator.world = std::move(*world);
    simulator.noise = noise_of(simulate);
    simulator.seed = simulate.seed;
    const bool is_odometry = options.poses == Poses::kOdometry || simulate.pose == "odometry";
    simulator.pose = is_odometry ? sim::PoseSent::kOdometry : sim::PoseSent::kTrue;
    simulator.poses = options.poses;
    if (auto chosen = choose_sensors(options, simulate, simulator); !chosen) return chosen.error();
    return simulator;
}

} // namespace

Result<PreparedSource> prepare_simulation(const RobotOptions& options, const SimulateOptions& simulate) {
    auto simulator = make_options(options, simulate);
    if (!simulator) return simulator.error();
    sim::SimulationLimits limits;
    if (simulate.duration) limits.duration = *simulate.duration;
    if (simulate.scans) limits.scans = *simulate.scans;
    const NoReturn no_return = options.no_return.value_or(NoReturn::kFree);
    PreparedSource prepared;
    prepared.speed = simulate.speed;
    prepared.body_radius = sim::kBodyRadius;
    if (simulate.drive == "explore") {
        auto exploring =
            std::make_unique<sim::ExploringSource>(std::move(*simulator), limits, no_return, simulate.speed);
        prepared.exploring = exploring.get();
        prepared.live = std::move(exploring);
        return prepared;
    }
    auto made = make_behaviour(simulate, simulator->world);
    if (!made) return made.error();
    prepared.fingerprint = sim::fingerprint_of(*simulator, made->name, no_return);
    prepared.source = std::make_unique<sim::SimulatedSource>(
        sim::Simulator(std::move(*simulator), std::move(made->behaviour)), limits, no_return);
    return prepared;
}

} // namespace scanloom::robot
