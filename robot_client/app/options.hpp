#pragma once

#include "common/app/program.hpp"
#include "robot_client/app/ld06_options.hpp"
#include "robot_client/source/source.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace scanloom::robot {

struct ReplayOptions {
    std::string file;
    double speed = 0.0; ///< 0 = as fast as the server takes it, 1 = as recorded
};

struct SimulateOptions {
    std::string world = "office";
    std::string drive = "wall_follower";
    std::string noise = "none";
    double noise_width = 0.05; ///< metres, of uniform noise
    std::string laser = "reference";
    std::uint64_t seed = 1;
    std::optional<double> duration; ///< seconds of the simulation
    std::optional<std::uint64_t> scans;
    double speed = 1.0; ///< 0 = as fast as the server takes it, 1 = real time
};

/// A recorded ring of sonars, see SonarLog.
struct SonarReplayOptions {
    std::string measurements;
    std::string poses;
    double aperture_deg = 30.0;
    double speed = 0.0; ///< as in ReplayOptions
};

struct RobotOptions {
    std::string host;
    std::string port;
    std::string session;
    std::string robot;
    std::string token_file;            ///< empty: no token
    std::optional<double> cell_size;   ///< metres
    std::optional<double> range_max;   ///< metres
    std::optional<double> body_radius; ///< metres
    std::optional<NoReturn> no_return;
    std::chrono::milliseconds give_up_after{120'000};
    std::variant<ReplayOptions, SonarReplayOptions, SimulateOptions, Ld06Options> source;
};

/// Reads the command line, SCANLOOM_* of the environment and the file of --config: a flag beats the environment,
/// which beats the file.
[[nodiscard]] std::variant<RobotOptions, Leave> parse_options(int argc, const char* const* argv);

} // namespace scanloom::robot
