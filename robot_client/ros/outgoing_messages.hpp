#pragma once

#include "common/geometry/pose2.hpp"
#include "robot_client/ros/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// The messages of ROS 1 and 2 that this program publishes.
namespace scanloom::robot {

inline constexpr std::string_view kGridType = "nav_msgs/OccupancyGrid";

/// The map of a nav_msgs/OccupancyGrid.
struct RosGrid {
    double resolution = 0.05; ///< metres per cell
    Pose2 T_map_grid;         ///< of the corner of cell (0, 0)
    std::size_t width = 0;    ///< cells
    std::string cells;        ///< bytes by rows, the lowest y first: 0 free, 100 occupied, -1 unknown

    [[nodiscard]] std::size_t height() const noexcept { return width == 0 ? 0 : cells.size() / width; }
};

/// Encodes a tf2_msgs/TFMessage of one transform in the plane.
/// @param parent        the stamp and the parent's frame
/// @param child         frame
/// @param T_parent_child  metres, radians
/// @param encoding      kRos1 or kCdr
[[nodiscard]] std::string encode_transform(const RosHeader& parent, std::string_view child, const Pose2& T_parent_child,
                                           MessageEncoding encoding);

/// Encodes a nav_msgs/OccupancyGrid.
/// @param header    the stamp and the map's frame
/// @param encoding  kRos1 or kCdr
[[nodiscard]] std::string encode_grid(const RosHeader& header, const RosGrid& grid, MessageEncoding encoding);

/// Returns the name of a type as ROS 1 or ROS 2 has it: "tf2_msgs/TFMessage", "tf2_msgs/msg/TFMessage".
/// @param type  without "msg/"
[[nodiscard]] std::string type_in(std::string_view type, MessageEncoding encoding);

} // namespace scanloom::robot
