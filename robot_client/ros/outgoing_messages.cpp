#include "robot_client/ros/outgoing_messages.hpp"

#include "robot_client/ros/ros_writer.hpp"

#include <cmath>
#include <utility>

namespace scanloom::robot {
namespace {

constexpr RosTime kNanosecondsPerSecond = 1'000'000'000;

void write_time(RosWriter& writer, RosTime time) {
    writer.number(static_cast<std::int32_t>(time / kNanosecondsPerSecond));
    writer.number(static_cast<std::uint32_t>(time % kNanosecondsPerSecond));
}

void write_header(RosWriter& writer, const RosHeader& header, MessageEncoding encoding) {
    if (encoding == MessageEncoding::kRos1) writer.number(std::uint32_t{0}); // seq, which ROS 1 sets itself
    write_time(writer, header.stamp);
    writer.text(header.frame);
}

void write_pose(RosWriter& writer, const Pose2& pose) {
    for (const double each : {pose.x, pose.y, 0.0, 0.0, 0.0, std::sin(pose.yaw / 2.0), std::cos(pose.yaw / 2.0)}) {
        writer.number(each);
    }
}

} // namespace

std::string encode_transform(const RosHeader& parent, std::string_view child, const Pose2& T_parent_child,
                             MessageEncoding encoding) {
    RosWriter writer(encoding);
    writer.number(std::uint32_t{1});
    write_header(writer, parent, encoding);
    writer.text(child);
    write_pose(writer, T_parent_child);
    return std::move(writer).take();
}

std::string encode_grid(const RosHeader& header, const RosGrid& grid, MessageEncoding encoding) {
    RosWriter writer(encoding);
    write_header(writer, header, encoding);
    write_time(writer, header.stamp); // when the map was loaded
    writer.number(static_cast<float>(grid.resolution));
    writer.number(static_cast<std::uint32_t>(grid.width));
    writer.number(static_cast<std::uint32_t>(grid.height()));
    write_pose(writer, grid.T_map_grid);
    writer.bytes(grid.cells);
    return std::move(writer).take();
}

std::string type_in(std::string_view type, MessageEncoding encoding) {
    std::string name(type);
    if (encoding == MessageEncoding::kCdr) name.insert(name.find('/') + 1, "msg/");
    return name;
}

} // namespace scanloom::robot
