#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/poses.hpp"
#include "common/wire/messages.hpp"

#include <optional>
#include <string>

#include <string_view>

namespace CLI {
class App;
}

namespace scanloom::robot {

/// Prefix of an input over the network.
inline constexpr std::string_view kTcpScheme = "tcp://";

/// An LD06 lidar or a recording of one; see Ld06ScanOptions for the readings.
struct Ld06Options {
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
    double speed = 0.0;               ///< of a capture file: 0 = as fast as the server accepts scans, 1 = as recorded
    double reopen_for = 60.0;         ///< seconds
};

/// Adds the subcommand, which sets `options`.
CLI::App* add_ld06(CLI::App& app, Ld06Options& options);

/// Returns an error that the parser cannot detect, or an empty string.
/// @param options  options of the subcommand
/// @param poses    what the robot's poses are
[[nodiscard]] std::string complaint_about(const Ld06Options& options, Poses poses);

} // namespace scanloom::robot
