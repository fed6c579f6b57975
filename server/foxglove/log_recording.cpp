#include "server/foxglove/log_recording.hpp"

#include "server/foxglove/grid_message.hpp"
#include "server/foxglove/log_time.hpp"
#include "server/foxglove/robot_messages.hpp"
#include "server/foxglove/topics.hpp"
#include "server/tiles/map_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <variant>

namespace scanloom::foxglove {
namespace {

/// The quality of service of maps, by which those who subscribe later get the newest one: as rosbag2 writes it.
/// Source: rosbag2_storage, YAML of rmw_qos_profile_t; 1 is keep last, reliable, transient local; 0 and the largest
/// times are the system's defaults.
constexpr std::string_view kLatched =
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    "  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  avoid_ros_namespace_conventions: false\n";

} // namespace

Result<> LogRecording::add(const LogEntry& entry) {
    ++revision_;
    if (const auto* joined = std::get_if<RobotJoined>(&entry)) robots_[joined->robot].name = joined->name;
    if (const auto* described = std::get_if<SensorDescribed>(&entry)) {
        robots_[described->robot].sensors[described->sensor.id] = described->sensor;
    }
    if (const auto* taken = std::get_if<ScanTaken>(&entry)) return add_scan(*taken);
    return {};
}

Result<> LogRecording::add_scan(const ScanTaken& taken) {
    const Scan& scan = taken.scan;
    const Robot& robot = robots_[taken.robot];
    const auto known = robot.sensors.find(scan.sensor);
    if (known == robot.sensors.end()) {
        return Error{Errc::kMalformed,
                     fmt::format("scan {} is of sensor {}, which was not described", scan.seq, scan.sensor)};
    }
    if (!has_room()) {
        return Error{Errc::kConflict, "the session has more topics than an MCAP file can have; request the log without "
                                      "format=mcap"};
    }
    const Sensor& sensor = known->second;
    const bool is_placed = is_in_trajectory(filter_.take(revision_, scan_pose_of(taken)));
    newest_ = std::max(newest_, scan.stamp);
    if (is_placed) {
        const RobotAt at{robot.name, scan.stamp, *scan.pose};
        const double half = std::fabs(scan.duration) / 2.0;
        const auto [newest, is_first] = newest_placed_.insert_or_assign(taken.robot, PlacedScan{at, &sensor, half});
        if (is_first && half > 0.0) write_transforms(newest->second, -half);
        write_transforms(newest->second, 0.0);
        write(pose_topic(robot.name), Message::kPose, scan.stamp, pose_message(at));
    }
    const std::string frame = is_placed ? sensor_frame(robot.name, sensor) : unplaced_frame(robot.name);
    write(scan_topic(robot.name, sensor.id), Message::kScan, scan.stamp, scan_message(frame, scan, sensor));
    return {};
}

/// Returns whether a scan's channels and those of the map fit.
bool LogRecording::has_room() const noexcept {
    constexpr std::size_t kOfAScan = 4; // with /map
    return channels_.size() + kOfAScan <= McapWriter::kChannelsMax;
}

/// @param after  seconds from the scan's stamp to that of the transforms
void LogRecording::write_transforms(const PlacedScan& scan, double after) {
    PlacedRobot placed{scan.at, {scan.sensor}};
    placed.at.stamp += after;
    write(kTransformsTopic, Message::kTransforms, placed.at.stamp, transforms_message(std::span(&placed, 1)));
}

void LogRecording::write(const std::string& topic, Message message, double stamp, const std::string& bytes) {
    const auto [channel, is_new] = channels_.try_emplace(topic);
    if (is_new) {
        channel->second =
            file_.add_channel(topic, schema_of(message), topic == kMapTopic ? kLatched : std::string_view());
    }
    file_.write(channel->second, nanoseconds_of(stamp), bytes);
}

void LogRecording::finish(const mapping::Snapshot& maps) {
    for (const auto& [robot, scan] : newest_placed_) {
        if (scan.half_duration > 0.0) write_transforms(scan, scan.half_duration);
    }
    const auto frame = tiles::map_frame(maps, mapping::Layer::kOccupancy, std::nullopt);
    if (frame) write(kMapTopic, Message::kGrid, newest_, grid_message(maps, *frame, newest_));
    file_.finish();
}

} // namespace scanloom::foxglove
