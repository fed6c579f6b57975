#include "robot_client/app/foxglove_options.hpp"

#include "common/app/command_line.hpp"
#include "robot_client/app/ros_options.hpp"

#include <CLI/CLI.hpp>

namespace scanloom::robot {

CLI::App* add_foxglove(CLI::App& app, FoxgloveOptions& options) {
    auto* foxglove = app.add_subcommand(
        "foxglove", "Map with a robot that runs foxglove_bridge, of ROS 1 or ROS 2, live; run this on the robot");
    // not required() in the parser, as for FILE of replay
    add_parsed(
        *foxglove, "URL", options.bridge,
        "ws://HOST:PORT or wss://HOST:PORT of the bridge; the port is 8765 if there is none. For wss, --tls-cert "
        "and --tls-key apply to it, too, and --tls-ca unless there is --bridge-ca",
        [](const std::string& text) { return parse_url(text, kWebSocketUrl); })
        ->configurable(false);
    foxglove
        ->add_option("--bridge-ca", options.bridge_ca_file,
                     "File with the certificate of the authority that signed that of a wss bridge")
        ->check(CLI::ExistingFile);
    add_checked(*foxglove, "--reopen-for", options.reopen_for,
                "Seconds during which to connect to the bridge again; 0 = not at all", check_within(0.0, 1e6));
    add_ros_options(*foxglove, options.robot, "Messages of the robot");
    const std::string group = "Publishing to the robot";
    foxglove
        ->add_flag("--publish-tf", options.publish_tf,
                   "Publish the transform map -> odom on /tf, 30 times a second, from the poses that the server "
                   "estimates. Needs odometry, and no other program that publishes it")
        ->group(group);
    foxglove
        ->add_flag("--publish-map", options.publish_map,
                   "Publish the session's map on /map, as nav_msgs/OccupancyGrid. Needs --http")
        ->group(group);
    foxglove->add_option("--map-frame", options.map_frame, "Name of the map's frame in what is published")
        ->group(group)
        ->capture_default_str();
    add_parsed(*foxglove, "--http", options.http,
               "http://HOST:PORT or https://HOST:PORT of the server's HTTP API, from which the map comes",
               [](const std::string& text) { return parse_url(text, kHttpUrl); })
        ->group(group);
    foxglove
        ->add_option("--http-token-file", options.http_token_file,
                     "File with the token of a viewer, for the HTTP API. Default: that of --token-file")
        ->check(CLI::ExistingFile)
        ->group(group);
    return foxglove;
}

std::string complaint_about(const FoxgloveOptions& options) {
    if (!options.bridge) return "foxglove: name the URL of the bridge, such as ws://127.0.0.1:8765";
    if (!options.bridge_ca_file.empty() && !options.bridge->is_encrypted)
        return "foxglove: --bridge-ca is only for a wss bridge; leave it out, or use wss://";
    if (options.publish_map && !options.http) {
        return "foxglove: --publish-map needs the server's HTTP API; give it with --http, such as "
               "--http http://127.0.0.1:8080";
    }
    if (options.http && !options.publish_map)
        return "foxglove: --http is only for --publish-map; give both, or neither";
    return {};
}

} // namespace scanloom::robot
