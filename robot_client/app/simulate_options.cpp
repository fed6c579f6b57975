#include "robot_client/app/simulate_options.hpp"

#include "common/app/command_line.hpp"
#include "sim/robot/world_file.hpp"

#include <fmt/format.h>

namespace scanloom::robot {
namespace {

std::string world_help(std::string text) {
    text += ": ";
    for (const sim::NamedWorld& world : sim::kWorlds) text.append(world.name).append(", ");
    return text + "or FILE.yaml, a map of ROS";
}

constexpr const char* kWorldsFooter =
    "Worlds, in metres, the origin in the middle of each, x to the right and y up:\n"
    "  room, room_walker  x -5 to 5, y -5 to 5; room_walker with a walking person\n"
    "  office             x -15 to 15, y -10 to 10\n"
    "  hall               x -30 to 30, y -20 to 20\n"
    "  FILE.yaml          by its origin; rays pass through unknown cells as if they were free, and\n"
    "                     hit nothing outside it";

void add_sensors(CLI::App& simulate, sim::SimulatedRobotOptions& options) {
    add_checked(
        simulate, "--laser", options.laser,
        "Laser: 684 beams over 180 degrees and 5 m; 360 over 360 degrees and 12 m; 1081 over 270 degrees and 30 m; or "
        "450 over 360 degrees and 12 m, one after another, of a lidar in the hand of a person who walks at 1 m/s",
        CLI::IsMember({"reference", "lidar360", "wide", "handheld", "none"}));
    add_checked(simulate, "--sonar", options.sonar, "Sonars, with or without a laser: 16 over 360 degrees, 5 m",
                CLI::IsMember({"none", "ring16"}));
}

void add_noise(CLI::App& simulate, sim::SimulatedRobotOptions& options) {
    add_checked(simulate, "--noise", options.noise, "Noise of its measurements",
                CLI::IsMember({"none", "gaussian", "uniform"}));
    simulate
        .add_option("--noise-width", options.noise_width,
                    fmt::format("Metres; uniform noise makes each reading too long by 0 up to this. Default: {}",
                                sim::kNoiseWidth))
        ->check(check_positive);
    simulate
        .add_option("--odometry-noise", options.odometry_noise,
                    "Odometry error, proportional to its motion: 0 = none, 1 = 5 % of each control step's motion and "
                    "0.02 rad per metre, 2 = twice that. Default: 1 with noise, 0 without")
        ->check(check_not_negative);
    // not checked in the parser: a SCANLOOM_POSE meant for another subcommand is not an error in this one
    simulate
        .add_option("--pose", options.pose,
                    "Pose sent with its scans if --poses is map: ground truth, or odometry from the true start")
        ->type_name("TEXT:{true,odometry}")
        ->capture_default_str();
}

void add_drive(CLI::App& simulate, sim::SimulatedRobotOptions& options) {
    add_checked(simulate, "--drive", options.drive,
                "Behaviour: along the walls on its right, endlessly; from waypoint to waypoint; back and forth "
                "over all free ground; or to the server's exploration goals, until nothing is left to explore",
                CLI::IsMember({"wall_follower", "waypoints", "zigzag", "explore"}));
    simulate
        .add_option("--waypoints", options.waypoints,
                    "Waypoints, in metres in the world frame (see below): \"x,y;x,y;...\", or a file with a line \"x "
                    "y\" for each. Default: a tour of the world, from the robot's position")
        ->type_name("LIST|FILE");
}

} // namespace

CLI::App* add_simulate(CLI::App& app, sim::SimulatedRobotOptions& options) {
    auto* simulate = app.add_subcommand("simulate", "Simulate a robot that drives through a world");
    simulate->footer(kWorldsFooter);
    add_checked(*simulate, "--world", options.world, world_help("The world"), sim::check_world);
    add_drive(*simulate, options);
    add_sensors(*simulate, options);
    add_noise(*simulate, options);
    add_checked(*simulate, "--seed", options.seed, "The same seed gives the same scans", check_whole_number_from(0));
    simulate
        ->add_option("--duration", options.duration,
                     "Seconds to simulate, earlier runs included; default: until the behaviour ends, or an interrupt")
        ->check(check_positive);
    simulate
        ->add_option("--scans", options.scans,
                     "Scans to take, earlier runs included; default: until the behaviour ends, or an interrupt")
        ->check(check_whole_number_from(1));
    add_checked(*simulate, "--speed", options.speed, "1 = real time, 0 = as fast as the server accepts scans",
                check_not_negative);
    return simulate;
}

CLI::App* add_ground_truth(CLI::App& app, GroundTruthOptions& options) {
    auto* truth = app.add_subcommand("truth", "Write the ground truth map of a world, without a server");
    truth->footer(
        "Unknown cells of a ROS map are unknown in its ground truth, too, although rays of simulated robots pass\n"
        "through them as if they were free: exclude them when a map is scored against the ground truth.");
    // not required() in the parser: an environment for several subcommands would then require them everywhere
    truth->add_option("--world", options.world, world_help("Of what"))->check(sim::check_world);
    add_checked(*truth, "--cell-size", options.cell_size, "Cell size in metres", check_within(0.01, 1.0));
    truth
        ->add_option("--output", options.output,
                     "Writes PREFIX.pgm and PREFIX.yaml, for map_server and imports; creates their folder")
        ->type_name("PREFIX");
    return truth;
}

namespace {

/// Returns why a robot with such poses cannot drive or be located, or nullopt.
std::optional<std::string> mistake_in_poses(const sim::SimulatedRobotOptions& options, Poses poses) {
    if (options.pose != "true" && options.pose != "odometry") {
        return fmt::format("simulate: --pose: '{}' is neither true nor odometry", options.pose);
    }
    if (options.pose == "odometry" && poses == Poses::kNone) {
        return "simulate: --pose odometry has no effect with --poses none; leave --pose out";
    }
    if (options.laser == "none" && poses == Poses::kNone) {
        return "simulate: with --poses none the server cannot locate a robot that has only sonars; give it a --laser";
    }
    if (options.drive == "zigzag" && poses == Poses::kOdometry) {
        return "simulate: --drive zigzag follows a plan, but --poses odometry drifts from it; use --poses map";
    }
    if (options.drive == "zigzag" && options.pose == "odometry") {
        return "simulate: --drive zigzag follows a plan, but --pose odometry drifts from it; use --pose true";
    }
    if (options.drive == "explore" && poses == Poses::kNone) {
        return "simulate: --drive explore follows paths in the map, in which --poses none sends no pose; use --poses "
               "map";
    }
    return std::nullopt;
}

} // namespace

std::optional<std::string> mistake_in(const sim::SimulatedRobotOptions& options, Poses poses) {
    if (options.laser == "none" && options.sonar == "none") {
        return "simulate: with --laser none the robot needs --sonar ring16";
    }
    if (options.laser == "none" && options.drive != "wall_follower") {
        return fmt::format("simulate: --drive {} needs a --laser: sonars do not measure where obstacles end",
                           options.drive);
    }
    if (options.laser == "handheld" && options.sonar != "none") {
        return "simulate: a person carries --laser handheld, without sonars; leave --sonar out";
    }
    if (auto mistake = mistake_in_poses(options, poses)) return mistake;
    if (options.noise_width && options.noise != "uniform") {
        return fmt::format("simulate: --noise-width does not apply to --noise {}; use --noise uniform", options.noise);
    }
    if (!options.waypoints.empty() && options.drive != "waypoints") {
        return fmt::format("simulate: --waypoints do not apply to --drive {}; use --drive waypoints", options.drive);
    }
    return std::nullopt;
}

std::optional<std::string> mistake_in(const GroundTruthOptions& options) {
    if (options.world.empty()) return "truth: name the --world";
    if (options.output.empty() || options.output.ends_with('/'))
        return "truth: name the files to write, --output PREFIX";
    return std::nullopt;
}

} // namespace scanloom::robot
