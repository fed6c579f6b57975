#include "server/foxglove/robot_messages.hpp"

#include "common/ros/ros_writer.hpp"
#include "common/scan/limits.hpp"
#include "server/foxglove/log_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <variant>
#include <vector>

namespace scanloom::foxglove {
namespace {

void add_transform(double stamp, std::string_view parent, std::string_view child, const Pose2& pose,
                   RosWriter& message) {
    message.add_header(nanoseconds_of(stamp), parent);
    message.add_text(child);
    message.add_pose(pose);
}

/// Returns a reading in metres: infinite for no return, NaN if it is invalid.
float metres_of(RangeMm range, const Sensor& sensor) {
    if (range == kInvalidRange) return std::numeric_limits<float>::quiet_NaN();
    const double metres = range * 1e-3;
    if (range == kNoReturn || metres >= sensor.range_max) return std::numeric_limits<float>::infinity();
    return metres < sensor.range_min ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(metres);
}

/// Evenly spaced beams.
struct Beams {
    UniformAngles angles;
    std::vector<float> ranges;      ///< metres
    std::vector<float> intensities; ///< empty, or one per beam
};

Beams beams_of(const Scan& scan, const Sensor& sensor) {
    Beams beams;
    const BeamAngles angles = angles_of(scan, sensor);
    const std::size_t count = scan.ranges.size();
    if (const auto* uniform = std::get_if<UniformAngles>(&angles)) {
        beams.angles = *uniform;
        for (const RangeMm range : scan.ranges) beams.ranges.push_back(metres_of(range, sensor));
        beams.intensities.assign(scan.intensities.begin(), scan.intensities.end());
        return beams;
    }
    double first = count == 0 ? 0.0 : beam_angle(angles, 0);
    double last = first;
    for (std::size_t n = 1; n < count; ++n) {
        first = std::min(first, beam_angle(angles, n));
        last = std::max(last, beam_angle(angles, n));
    }
    const std::size_t made = std::min(2 * count, std::size_t{kBeamsMax});
    beams.angles = {first, made > 1 ? (last - first) / static_cast<double>(made - 1) : 0.0,
                    static_cast<std::uint32_t>(made)};
    beams.ranges.assign(made, std::numeric_limits<float>::quiet_NaN());
    if (!scan.intensities.empty()) beams.intensities.assign(made, 0.0F);
    for (std::size_t n = 0; n < count; ++n) {
        const double place =
            beams.angles.increment > 0.0 ? (beam_angle(angles, n) - first) / beams.angles.increment : 0.0;
        const auto nearest = static_cast<std::size_t>(std::lround(place));
        beams.ranges[nearest] = metres_of(scan.ranges[n], sensor);
        if (!scan.intensities.empty()) beams.intensities[nearest] = static_cast<float>(scan.intensities[n]);
    }
    return beams;
}

} // namespace

std::string robot_frame(std::string_view robot) { return fmt::format("{}/base_link", robot); }

std::string unplaced_frame(std::string_view robot) { return fmt::format("{}/unplaced", robot); }

std::string sensor_frame(std::string_view robot, const Sensor& sensor) {
    return fmt::format("{}/sensor_{}", robot, sensor.id);
}

std::string transforms_message(std::span<const PlacedRobot> robots) {
    RosWriter message(RosEncoding::kCdr);
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
    RosWriter message(RosEncoding::kCdr);
    message.add_header(nanoseconds_of(at.stamp), kMapFrame);
    message.add_pose(at.T_map_robot);
    return message.take();
}

std::string path_message(std::span<const Pose2> poses, double stamp) {
    RosWriter message(RosEncoding::kCdr);
    message.add_header(nanoseconds_of(stamp), kMapFrame);
    message.add_count(poses.size());
    for (const Pose2& pose : poses) {
        message.add_header(nanoseconds_of(stamp), kMapFrame);
        message.add_pose(pose);
    }
    return message.take();
}

std::string scan_message(std::string_view frame, const Scan& scan, const Sensor& sensor) {
    const auto [angles, ranges, intensities] = beams_of(scan, sensor);
    const double gaps = ranges.size() > 1 ? static_cast<double>(ranges.size() - 1) : 1.0;
    RosWriter message(RosEncoding::kCdr);
    message.add_header(nanoseconds_of(first_beam_stamp(scan)), frame);
    for (const double value : {angles.first, angles.first + gaps * angles.increment, angles.increment,
                               scan.duration / gaps, std::fabs(scan.duration), sensor.range_min, sensor.range_max}) {
        message.add(static_cast<float>(value));
    }
    for (const auto& list : {ranges, intensities}) {
        message.add_count(list.size());
        for (const float value : list) message.add(value);
    }
    return message.take();
}

} // namespace scanloom::foxglove
