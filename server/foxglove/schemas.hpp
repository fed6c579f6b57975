#pragma once

#include <string>
#include <string_view>

namespace scanloom::foxglove {

/// What a channel carries: standard messages of ROS 2, which its tools read, too, and scenes.
enum class Message {
    kTransforms, ///< tf2_msgs/msg/TFMessage
    kPose,       ///< geometry_msgs/msg/PoseStamped
    kScan,       ///< sensor_msgs/msg/LaserScan
    kGrid,       ///< nav_msgs/msg/OccupancyGrid
    kPath,       ///< nav_msgs/msg/Path
    kStatus,     ///< diagnostic_msgs/msg/DiagnosticArray
    kScene,      ///< foxglove.SceneUpdate, in Protocol Buffers
};

/// How readers decode a message. Strings are the names of the MCAP and WebSocket specifications.
struct Schema {
    std::string name;                  ///< of the message's type
    std::string_view encoding;         ///< of the schema: ros2msg or protobuf
    std::string_view message_encoding; ///< of the messages: cdr or protobuf
    std::string data; ///< the text of the definition, or a serialised google.protobuf.FileDescriptorSet
};

/// Returns the schema of a message.
/// Threads: any.
[[nodiscard]] const Schema& schema_of(Message message);

} // namespace scanloom::foxglove
