#pragma once

#include "common/app/link_options.hpp"
#include "common/app/program.hpp"
#include "common/scan/poses.hpp"
#include "robot_client/app/foxglove_options.hpp"
#include "robot_client/app/lidar_options.hpp"
#include "robot_client/app/replay_options.hpp"
#include "robot_client/sources/source.hpp"
#include "robot_client/spool/spool.hpp"
#include "sim/robot/simulated_robot.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

namespace scanloom::robot {

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
    std::optional<Poses> poses; ///< what the poses of the source are; nullopt: the source decides, most have kMap
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
    std::variant<ReplayOptions, SonarReplayOptions, sim::SimulatedRobotOptions, LidarOptions, FoxgloveOptions> source;
};

/// Reads the command line, SCANLOOM_* environment variables and the file of --config. Flags override the environment,
/// which overrides the file.
[[nodiscard]] std::variant<RobotOptions, GroundTruthOptions, InfoOptions, LidarsOptions, Leave>
parse_options(int argc, const char* const* argv);

} // namespace scanloom::robot
