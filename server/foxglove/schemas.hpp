#pragma once

#include <string>
#include <string_view>

namespace scanloom::foxglove {

/// What a channel carries: standard messages of ROS 2, which its tools and viewers read, too.
enum class Message {
    kTransforms, ///< tf2_msgs/msg/TFMessage
    kPose,       ///< geometry_msgs/msg/PoseStamped
    kScan,       ///< sensor_msgs/msg/LaserScan
    kPoints,     ///< sensor_msgs/msg/PointCloud2
    kGrid,       ///< nav_msgs/msg/OccupancyGrid
};

/// How readers decode a message. Strings are the names of the MCAP and WebSocket specifications.
struct Schema {
    std::string name;                  ///< of the message's type
    std::string_view encoding;         ///< of the schema: ros2msg
    std::string_view message_encoding; ///< of the messages: cdr
    std::string data;                  ///< the text of the definition
};

/// Returns the schema of a message.
/// Threads: any.
[[nodiscard]] const Schema& schema_of(Message message);

} // namespace scanloom::foxglove
