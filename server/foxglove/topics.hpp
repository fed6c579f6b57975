#pragma once

#include "server/foxglove/schemas.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>

/// Names of topics, in MCAP files and over WebSocket.
namespace scanloom::foxglove {

inline const std::string kTransformsTopic = "/tf"; ///< Message::kTransforms of all robots
inline const std::string kMapTopic = "/map";       ///< Message::kGrid of the occupancy
inline const std::string kStatusTopic = "/diagnostics";
inline const std::string kLandmarksTopic = "/landmarks"; ///< Message::kScene, as the next three
inline const std::string kFrontiersTopic = "/frontiers";
inline const std::string kGoalsTopic = "/goals";
inline const std::string kPoseGraphTopic = "/pose_graph";

/// Returns the topic of a robot's poses.
[[nodiscard]] inline std::string pose_topic(std::string_view robot) { return fmt::format("/{}/pose", robot); }

/// Returns the topic of where a robot has been: Message::kPath.
[[nodiscard]] inline std::string trail_topic(std::string_view robot) { return fmt::format("/{}/trail", robot); }

/// Returns the topic of the path that a robot follows: Message::kPath.
[[nodiscard]] inline std::string path_topic(std::string_view robot) { return fmt::format("/{}/path", robot); }

/// Returns the topic of the scans of a robot's sensor: /ROBOT/scan of sensor 0, /ROBOT/scan_1 of sensor 1.
[[nodiscard]] inline std::string scan_topic(std::string_view robot, std::uint32_t sensor) {
    return sensor == 0 ? fmt::format("/{}/scan", robot) : fmt::format("/{}/scan_{}", robot, sensor);
}

} // namespace scanloom::foxglove
