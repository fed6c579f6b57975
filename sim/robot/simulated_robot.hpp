#pragma once

#include "common/error/error.hpp"
#include "common/scan/poses.hpp"
#include "robot_client/sources/source.hpp"
#include "sim/robot/exploring_source.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::sim {

inline constexpr double kNoiseWidth = 0.05; ///< metres

/// A simulated robot, as the command line describes it.
struct SimulatedRobotOptions {
    std::string world = "office";         ///< for load_world()
    std::string drive = "wall_follower";  ///< or waypoints, zigzag, explore
    std::string waypoints;                ///< for read_waypoints(); empty: a tour of the world
    std::string noise = "none";           ///< or gaussian, uniform
    std::optional<double> noise_width;    ///< metres, of uniform noise; absent: kNoiseWidth
    std::optional<double> odometry_noise; ///< a factor; absent: 1 with noise, 0 without
    std::string laser = "reference";      ///< for find_laser(), or none
    std::string sonar = "none";           ///< for find_sonar(), or none
    std::string pose = "true";            ///< or odometry; what it sends if its poses are Poses::kMap
    Poses poses = Poses::kMap;            ///< what it knows of its poses
    std::uint64_t seed = 1;
    std::optional<double> duration;     ///< seconds of simulated time; absent: no limit
    std::optional<std::uint64_t> scans; ///< of all sensors; absent: no limit
    double speed = 1.0;                 ///< 0 = as fast as the server accepts scans, 1 = real time
    std::optional<double> range_max;    ///< metres; absent: that of each sensor
    robot::NoReturn no_return = robot::NoReturn::kFree;
};

/// A simulated robot as a source of scans: exactly one of the two pointers is set.
struct SimulatedRobot {
    std::unique_ptr<robot::Source> source;      ///< its scans depend on the options only
    std::unique_ptr<ExploringSource> exploring; ///< its scans depend on the server's replies; needs ask_with()
    std::string fingerprint;                    ///< of `source`, see fingerprint_of(); otherwise empty
};

/// Sets up a simulated robot.
/// @return the robot at its start, before its first scan
/// Errors: those of load_world() and read_waypoints(); kNotFound for an unknown sensor; kInvalidField for a sensor
///         without a range, and for waypoints that are not given in a world without a tour.
[[nodiscard]] Result<SimulatedRobot> make_simulated_robot(const SimulatedRobotOptions& options);

} // namespace scanloom::sim
