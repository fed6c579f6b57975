#include "server/foxglove/robot_messages.hpp"

#include "server/foxglove/ros_fields.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <variant>
#include <vector>

namespace scanloom::foxglove {
namespace {

void add_transform(double stamp, std::string_view parent, std::string_view child, const Pose2& pose,
                   CdrWriter& message) {
    add_header(stamp, parent, message);
    message.add_text(child);
    add_pose(pose, message);
}

/// Returns a reading in metres: infinite for no return, NaN if it is invalid.
float metres_of(RangeMm range, const Sensor& sensor) {
    if (range == kInvalidRange) return std::numeric_limits<float>::quiet_NaN();
    const double metres = range * 1e-3;
    if (range == kNoReturn || metres >= sensor.range_max) return std::numeric_limits<float>::infinity();
    return metres < sensor.range_min ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(metres);
}

/// The stamp of a sensor_msgs/LaserScan is that of its first beam.
std::string evenly_spaced(std::string_view frame, const Scan& scan, const Sensor& sensor) {
    const auto angles = std::get<UniformAngles>(angles_of(scan, sensor));
    const std::size_t count = scan.ranges.size();
    const double gaps = count > 1 ? static_cast<double>(count - 1) : 1.0;
    CdrWriter message;
    add_header(scan.stamp - scan.duration / 2.0, frame, message);
    for (const double value : {angles.first, angles.first + gaps * angles.increment, angles.increment,
                               scan.duration / gaps, scan.duration, sensor.range_min, sensor.range_max}) {
        message.add(static_cast<float>(value));
    }
    message.add_count(count);
    for (const RangeMm range : scan.ranges) message.add(metres_of(range, sensor));
    message.add_count(scan.intensities.size());
    for (const std::uint32_t intensity : scan.intensities) message.add(static_cast<float>(intensity));
    return message.take();
}

using Point = std::array<float, 3>; // x, y, z

std::vector<Point> hits_of(const Scan& scan, const Sensor& sensor) {
    const BeamAngles angles = angles_of(scan, sensor);
    std::vector<Point> points;
    for (std::size_t n = 0; n < scan.ranges.size(); ++n) {
        const float range = metres_of(scan.ranges[n], sensor);
        const double angle = beam_angle(angles, n);
        const auto along = [range](double part) { return static_cast<float>(range * part); };
        if (std::isfinite(range)) points.push_back({along(std::cos(angle)), along(std::sin(angle)), 0.0F});
    }
    return points;
}

std::string points_of(std::string_view frame, const Scan& scan, const Sensor& sensor) {
    constexpr std::uint8_t kFloat32 = 7; // sensor_msgs/PointField
    const std::vector<Point> points = hits_of(scan, sensor);
    CdrWriter message;
    add_header(scan.stamp, frame, message);
    message.add_count(1); // height
    message.add_count(points.size());
    message.add_count(std::tuple_size_v<Point>); // fields
    std::uint32_t offset = 0;
    for (const std::string_view name : {"x", "y", "z"}) {
        message.add_text(name);
        message.add(std::exchange(offset, offset + static_cast<std::uint32_t>(sizeof(float))));
        message.add(kFloat32);
        message.add_count(1);
    }
    message.add(false); // is_bigendian
    message.add_count(sizeof(Point));
    message.add_count(sizeof(Point) * points.size()); // bytes of a row
    message.add_bytes(std::as_bytes(std::span(points)));
    message.add(true); // is_dense: no point is invalid
    return message.take();
}

} // namespace

std::string robot_frame(std::string_view robot) { return fmt::format("{}/base_link", robot); }

std::string unplaced_frame(std::string_view robot) { return fmt::format("{}/unplaced", robot); }

std::string sensor_frame(std::string_view robot, const Sensor& sensor) {
    return fmt::format("{}/sensor_{}", robot, sensor.id);
}

std::string transforms_message(std::span<const PlacedRobot> robots) {
    CdrWriter message;
    std::size_t count = robots.size();
    for (const auto& [at, sensors] : robots) count += sensors.size();
    message.add_count(count);
    for (const auto& [at, sensors] : robots) {
        const std::string robot = robot_frame(at.robot);
        add_transform(at.stamp, kMapFrame, robot, at.T_map_robot, message);
        for (const Sensor* sensor : sensors) {
            add_transform(at.stamp, robot, sensor_frame(at.robot, *sensor), sensor->mount, message);
        }
    }
    return message.take();
}

std::string pose_message(const RobotAt& at) {
    CdrWriter message;
    add_header(at.stamp, kMapFrame, message);
    add_pose(at.T_map_robot, message);
    return message.take();
}

std::string path_message(std::span<const Pose2> poses, double stamp) {
    CdrWriter message;
    add_header(stamp, kMapFrame, message);
    message.add_count(poses.size());
    for (const Pose2& pose : poses) {
        add_header(stamp, kMapFrame, message);
        add_pose(pose, message);
    }
    return message.take();
}

Message message_of(const Scan& scan, const Sensor& sensor) noexcept {
    const BeamAngles& angles = scan.angles ? *scan.angles : sensor.angles;
    return std::holds_alternative<UniformAngles>(angles) ? Message::kScan : Message::kPoints;
}

std::string scan_message(std::string_view frame, const Scan& scan, const Sensor& sensor) {
    return message_of(scan, sensor) == Message::kScan ? evenly_spaced(frame, scan, sensor)
                                                      : points_of(frame, scan, sensor);
}

} // namespace scanloom::foxglove
