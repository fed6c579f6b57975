#include "server/foxglove/log_recording.hpp"

#include "server/foxglove/grid_message.hpp"
#include "server/foxglove/robot_messages.hpp"
#include "server/foxglove/ros_fields.hpp"
#include "server/foxglove/topics.hpp"
#include "server/tiles/map_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <variant>

namespace scanloom::foxglove {

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
    const Sensor& sensor = known->second;
    const bool is_placed = is_in_trajectory(filter_.take(revision_, scan_pose_of(taken)));
    newest_ = std::max(newest_, scan.stamp);
    if (is_placed) {
        const RobotAt at{robot.name, scan.stamp, *scan.pose};
        const PlacedRobot placed{at, {&sensor}};
        write(kTransformsTopic, Message::kTransforms, scan.stamp, transforms_message(std::span(&placed, 1)));
        write(pose_topic(robot.name), Message::kPose, scan.stamp, pose_message(at));
    }
    const Message kind = message_of(scan, sensor);
    const std::string frame = is_placed ? sensor_frame(robot.name, sensor) : unplaced_frame(robot.name);
    write(scan_topic(robot.name, sensor.id, kind), kind, scan.stamp, scan_message(frame, scan, sensor));
    return {};
}

void LogRecording::write(const std::string& topic, Message message, double stamp, const std::string& bytes) {
    const auto [channel, is_new] = channels_.try_emplace(topic);
    if (is_new) channel->second = file_.add_channel(topic, schema_of(message));
    file_.write(channel->second, log_time_of(stamp), bytes);
}

void LogRecording::finish(const mapping::Snapshot& maps) {
    constexpr auto kLayer = mapping::Layer::kOccupancy;
    const auto frame = tiles::map_frame(maps, kLayer, std::nullopt);
    if (frame) write(kMapTopic, Message::kGrid, newest_, grid_message(maps, kLayer, *frame, newest_));
    file_.finish();
}

} // namespace scanloom::foxglove
