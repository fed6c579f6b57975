#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/poses.hpp"
#include "common/wire/messages.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace scanloom::robot {

/// Prefix of an input over the network.
inline constexpr std::string_view kTcpScheme = "tcp://";

/// A lidar, or a recording of an LD06; see LidarScanOptions for the readings.
struct LidarOptions {
    bool is_ld06_command = false;    ///< the subcommand is `ld06`, which also reads capture files
    std::string model;               ///< see lidar_models()
    std::string input;               ///< a capture file, a serial device, or tcp://HOST:PORT
    std::optional<Pose2> pose;       ///< of a stationary robot
    std::string pose_file;           ///< a file of poses; "-": stdin
    bool is_old_name = false;        ///< the file was given with --poses, the earlier name of --pose-file, until 0.4
    bool locate = false;             ///< the server localizes the lidar; `pose` is the first place if no map exists
    std::optional<wire::Near> near;  ///< with `locate`: prior; none: anywhere in the map
    Pose2 mount;                     ///< T_robot_sensor
    std::optional<double> range_min; ///< metres
    std::optional<int> confidence_min;
    std::optional<int> median_window; ///< beams
    std::optional<unsigned> baud;     ///< of a serial device; none: that of the model
    double speed = 0.0;               ///< of a capture file: 0 = as fast as the server accepts scans, 1 = as recorded
    double reopen_for = 60.0;         ///< seconds

    /// Returns the name of the subcommand.
    [[nodiscard]] std::string_view command() const noexcept { return is_ld06_command ? "ld06" : "lidar"; }
};

/// Lists which lidars are plugged in; needs no server.
struct LidarsOptions {
    std::vector<std::string> devices; ///< serial devices or tcp://HOST:PORT; empty: all serial devices of USB adapters
    double wait = 0.4;                ///< seconds that each kind of lidar has to answer
};

/// Adds the subcommand `ld06`, which sets `options`.
CLI::App* add_ld06(CLI::App& app, LidarOptions& options);

/// Adds the subcommand `lidar`, which sets `options`.
CLI::App* add_lidar(CLI::App& app, LidarOptions& options);

/// Adds the subcommand `lidars`, which sets `options`.
CLI::App* add_lidars(CLI::App& app, LidarsOptions& options);

/// Returns an error that the parser cannot detect, or an empty string.
[[nodiscard]] std::string complaint_about(const LidarsOptions& options);

/// Returns an error that the parser cannot detect, or an empty string.
/// @param options  options of the subcommand
/// @param poses    what the robot's poses are
[[nodiscard]] std::string complaint_about(const LidarOptions& options, Poses poses);

} // namespace scanloom::robot
