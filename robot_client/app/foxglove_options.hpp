#pragma once

#include "common/error/error.hpp"
#include "robot_client/foxglove/url.hpp"
#include "robot_client/ros/recording_options.hpp"

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace scanloom::robot {

/// A robot that runs foxglove_bridge.
struct FoxgloveOptions {
    std::optional<Url> bridge;
    RecordingOptions robot;   ///< poses and the largest range are not set here
    double reopen_for = 60.0; ///< seconds
    bool publish_tf = false;  ///< map -> odometry frame
    bool publish_map = false;
    std::string map_frame = "map";
    std::string bridge_ca_file;  ///< for wss; empty: that of the link to the server
    std::optional<Url> http;     ///< the server's, for the map
    std::string http_token_file; ///< empty: the token of the robot
};

/// Adds the subcommand, which sets `options`.
CLI::App* add_foxglove(CLI::App& app, FoxgloveOptions& options);

/// Returns an error that the parser cannot detect, or an empty string.
[[nodiscard]] std::string complaint_about(const FoxgloveOptions& options);

} // namespace scanloom::robot
