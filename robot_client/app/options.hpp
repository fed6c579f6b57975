#pragma once

#include "common/app/link_options.hpp"
#include "common/app/program.hpp"
#include "common/scan/poses.hpp"
#include "robot_client/app/ld06_options.hpp"
#include "robot_client/sources/source.hpp"
#include "robot_client/spool/spool.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

namespace scanloom::robot {

struct ReplayOptions {
    std::string file;
    double speed = 0.0; ///< 0 = as fast as the server accepts scans, 1 = as recorded
};

inline constexpr double kNoiseWidth = 0.05; ///< metres

struct SimulateOptions {
    std::string world = "office"; ///< a name, or the YAML file of a ROS map
    std::string drive = "wall_follower";
    std::string waypoints; ///< for read_waypoints(); empty: a tour of the world
    std::string noise = "none";
    std::optional<double> noise_width;    ///< metres, of uniform noise; absent: kNoiseWidth
    std::optional<double> odometry_noise; ///< a factor; absent: 1 with noise, 0 without
    std::string laser = "reference";      ///< or none
    std::string sonar = "none";
    std::string pose = "true"; ///< or odometry; what it sends if its poses are Poses::kMap
    std::uint64_t seed = 1;
    std::optional<double> duration; ///< seconds of simulated time
    std::optional<std::uint64_t> scans;
    double speed = 1.0; ///< 0 = as fast as the server accepts scans, 1 = real time
};

/// Writes the ground truth of a world as map files; needs no server.
struct GroundTruthOptions {
    std::string world;
    double cell_size = 0.05; ///< metres
    std::string output;      ///< path of the files without .pgm and .yaml
};

/// A recording of a ring of sonars, see SonarLog.
struct SonarReplayOptions {
    std::string measurements;
    std::string poses;
    double aperture_deg = 30.0;
    double speed = 0.0; ///< as in ReplayOptions
};

struct RobotOptions : LinkOptions {
    std::string session;
    std::string robot;
    std::optional<double> cell_size;   ///< metres
    std::optional<double> range_max;   ///< metres
    std::optional<double> body_radius; ///< metres
    std::optional<NoReturn> no_return;
    Poses poses = Poses::kMap; ///< what the poses of the source are, and therefore how scans are sent
    std::optional<std::chrono::milliseconds> give_up_after; ///< 0: never

    // buffers
    std::filesystem::path spool; ///< empty: none
    std::uint64_t spool_bytes_max = 0;
    WhenFull when_full = WhenFull::kDropOldest;
    std::uint64_t memory_bytes_max = 0;

    // transmission
    std::chrono::milliseconds batch_delay{0};
    std::uint64_t batch_bytes_max = 0;
    bool compress = false;
    std::variant<ReplayOptions, SonarReplayOptions, SimulateOptions, Ld06Options> source;
};

/// Reads the command line, SCANLOOM_* environment variables and the file of --config. Flags override the environment,
/// which overrides the file.
[[nodiscard]] std::variant<RobotOptions, GroundTruthOptions, Leave> parse_options(int argc, const char* const* argv);

} // namespace scanloom::robot
