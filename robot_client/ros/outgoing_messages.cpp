#include "robot_client/ros/outgoing_messages.hpp"

#include "common/ros/ros_writer.hpp"

#include <cstdint>
#include <span>

namespace scanloom::robot {
namespace {

RosWriter writer_of(MessageEncoding encoding) {
    return RosWriter(encoding == MessageEncoding::kCdr ? RosEncoding::kCdr : RosEncoding::kRos1);
}

} // namespace

std::string encode_transform(const RosHeader& parent, std::string_view child, const Pose2& T_parent_child,
                             MessageEncoding encoding) {
    RosWriter writer = writer_of(encoding);
    writer.add_count(1);
    writer.add_header(parent.stamp, parent.frame);
    writer.add_text(child);
    writer.add_pose(T_parent_child);
    return writer.take();
}

std::string encode_grid(const RosHeader& header, const RosGrid& grid, MessageEncoding encoding) {
    RosWriter writer = writer_of(encoding);
    writer.add_header(header.stamp, header.frame);
    writer.add_time(header.stamp); // when the map was loaded
    writer.add(static_cast<float>(grid.resolution));
    writer.add_count(grid.width);
    writer.add_count(grid.height());
    writer.add_pose(grid.T_map_grid);
    writer.add_bytes(std::span(grid.cells));
    return writer.take();
}

std::string type_in(std::string_view type, MessageEncoding encoding) {
    std::string name(type);
    if (encoding == MessageEncoding::kCdr) name.insert(name.find('/') + 1, "msg/");
    return name;
}

} // namespace scanloom::robot
