#pragma once

#include "common/geometry/pose2.hpp"
#include "common/wire/messages.hpp"

#include <optional>
#include <string>

#include <string_view>

namespace CLI {
class App;
}

namespace scanloom::robot {

/// What an input over the network begins with.
inline constexpr std::string_view kTcpScheme = "tcp://";

/// An LD06 lidar, or what one sent; see Ld06ScanOptions for the readings.
struct Ld06Options {
    std::string input;               ///< a capture file, a serial device, or tcp://HOST:PORT
    std::optional<Pose2> pose;       ///< of a robot that stands; else `poses`, or `locate`
    std::string poses;               ///< a file of poses; "-": stdin
    bool locate = false;             ///< the server tells the place, `pose` only that of the first if nothing is mapped
    std::optional<wire::Near> near;  ///< with `locate`: where it must be; none: anywhere in the map
    Pose2 mount;                     ///< T_robot_sensor
    std::optional<double> range_min; ///< metres
    std::optional<int> confidence_min;
    std::optional<int> median_window; ///< beams
    double speed = 0.0;               ///< of a capture file: 0 = as fast as the server takes it, 1 = as recorded
    double reopen_for = 60.0;         ///< seconds
};

/// Adds the subcommand, which fills `options`.
CLI::App* add_ld06(CLI::App& app, Ld06Options& options);

/// What the parser cannot tell; empty: nothing is wrong.
[[nodiscard]] std::string complaint_about(const Ld06Options& options);

} // namespace scanloom::robot
