#include "sim/robot/simulated_robot.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/drive/wall_follower.hpp"
#include "sim/drive/waypoints.hpp"
#include "sim/drive/zigzag.hpp"
#include "sim/ground_truth.hpp"
#include "sim/robot/simulated_source.hpp"
#include "sim/robot/waypoint_list.hpp"
#include "sim/robot/world_file.hpp"
#include "sim/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace scanloom::sim {
namespace {

constexpr double kPlanCellSize = 0.05; // metres

/// Returns why a robot cannot be at a place, whatever its path.
std::string unreachable(const World& world, const Point2& place) {
    if (!bounds_of(world).contains(place)) return "outside the world";
    if (world.obstacles->contain(place)) return "inside an obstacle";
    if (world.obstacles->distance(place) < kBodyRadius) return "too close to an obstacle";
    return {};
}

struct NamedBehaviour {
    std::unique_ptr<Behaviour> behaviour;
    std::string name; ///< includes the parameters and the version: the same name drives in the same way
};

Result<NamedBehaviour> make_waypoints(const SimulatedRobotOptions& options, const World& world) {
    const bool is_tour = options.waypoints.empty();
    auto waypoints = is_tour ? Result<std::vector<Point2>>(tour_of(world.name)) : read_waypoints(options.waypoints);
    if (!waypoints) return waypoints.error();
    if (waypoints->empty()) {
        return Error{Errc::kInvalidField, fmt::format("the world {} has no tour; give --waypoints", options.world)};
    }
    std::string name = fmt::format("{} {}", is_tour ? "tour" : "waypoints", to_text(*waypoints));
    return NamedBehaviour{
        std::make_unique<Waypoints>(std::move(*waypoints), is_tour ? TourStart::kNearest : TourStart::kFirst,
                                    [world](const Point2& place) { return unreachable(world, place); }),
        std::move(name)};
}

/// Makes the behaviour of a robot that needs no goals from the server.
Result<NamedBehaviour> make_behaviour(const SimulatedRobotOptions& options, const World& world) {
    if (options.drive == "waypoints") return make_waypoints(options, world);
    if (options.drive == "zigzag") {
        return NamedBehaviour{std::make_unique<Zigzag>(floor_plan_of(ground_truth_of(world, kPlanCellSize))),
                              "zigzag 2"};
    }
    return NamedBehaviour{std::make_unique<WallFollower>(), options.drive};
}

Result<> check_range(const Sensor& sensor) {
    if (sensor.range_max > sensor.range_min) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("--max-range is {} m, but the {} {} has a minimum range of {} m", sensor.range_max,
                             sensor.kind == SensorKind::kLaser ? "laser" : "sonar", sensor.name, sensor.range_min)};
}

/// Errors: unknown names, and a range that leaves a sensor nothing to measure.
Result<> choose_sensors(const SimulatedRobotOptions& options, SimulatorOptions& simulator) {
    if (options.laser != "none") {
        auto laser = find_laser(options.laser);
        if (!laser) return laser.error();
        if (options.range_max) laser->range_max = *options.range_max;
        if (auto ok = check_range(*laser); !ok) return ok.error();
        simulator.laser = std::move(*laser);
        simulator.is_carried = options.laser == "handheld";
    }
    if (options.sonar != "none") {
        auto sonar = find_sonar(options.sonar);
        if (!sonar) return sonar.error();
        sonar->range_max = std::min(sonar->range_max, options.range_max.value_or(sonar->range_max));
        if (auto ok = check_range(*sonar); !ok) return ok.error();
        simulator.sonar = std::move(*sonar);
    }
    return {};
}

std::optional<Noise> noise_of(const SimulatedRobotOptions& options) {
    constexpr Noise kOfOdometryOnly{.range = 0.0, .beam_angle = 0.0};
    const double odometry = options.odometry_noise.value_or(options.noise == "none" ? 0.0 : 1.0);
    if (options.noise == "gaussian") return with_odometry({}, odometry);
    if (options.noise == "uniform") {
        Noise noise = kOfOdometryOnly;
        noise.range_uniform = options.noise_width.value_or(kNoiseWidth);
        return with_odometry(noise, odometry);
    }
    if (odometry > 0.0) return with_odometry(kOfOdometryOnly, odometry);
    return std::nullopt;
}

Result<SimulatorOptions> simulator_options(const SimulatedRobotOptions& options) {
    auto world = load_world(options.world);
    if (!world) return world.error();
    SimulatorOptions simulator;
    simulator.world = std::move(*world);
    simulator.noise = noise_of(options);
    simulator.seed = options.seed;
    const bool is_odometry = options.poses == Poses::kOdometry || options.pose == "odometry";
    simulator.pose = is_odometry ? PoseSent::kOdometry : PoseSent::kTrue;
    simulator.poses = options.poses;
    if (auto chosen = choose_sensors(options, simulator); !chosen) return chosen.error();
    return simulator;
}

} // namespace

Result<SimulatedRobot> make_simulated_robot(const SimulatedRobotOptions& options) {
    auto simulator = simulator_options(options);
    if (!simulator) return simulator.error();
    SimulationLimits limits;
    if (options.duration) limits.duration = *options.duration;
    if (options.scans) limits.scans = *options.scans;
    SimulatedRobot robot;
    if (options.drive == "explore") {
        robot.exploring =
            std::make_unique<ExploringSource>(std::move(*simulator), limits, options.no_return, options.speed);
        return robot;
    }
    auto made = make_behaviour(options, simulator->world);
    if (!made) return made.error();
    robot.fingerprint = fingerprint_of(*simulator, made->name, options.no_return);
    robot.source = std::make_unique<SimulatedSource>(Simulator(std::move(*simulator), std::move(made->behaviour)),
                                                     limits, options.no_return);
    return robot;
}

} // namespace scanloom::sim
