#include "server/foxglove/session_feed.hpp"

#include "server/foxglove/grid_message.hpp"
#include "server/foxglove/robot_messages.hpp"
#include "server/foxglove/ros_fields.hpp"
#include "server/foxglove/scene_messages.hpp"
#include "server/foxglove/status_message.hpp"
#include "server/foxglove/topics.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::foxglove {
namespace {

using mapping::RobotState;
using mapping::Snapshot;

constexpr auto kLayer = mapping::Layer::kOccupancy;
constexpr std::size_t kTrailPoints = 2'048; // of a robot, at most

/// Returns the newest stamp of any robot, in seconds.
double newest_stamp(const Snapshot& maps) {
    double newest = 0.0;
    for (const RobotState& robot : maps.robots) newest = std::max(newest, robot.stamp);
    return newest;
}

std::string transforms_of(const Snapshot& maps) {
    std::vector<PlacedRobot> robots;
    for (const RobotState& robot : maps.robots) {
        if (!robot.pose) continue;
        robots.push_back({{robot.name, robot.stamp, *robot.pose}, {}});
        if (robot.newest_scan) robots.back().sensors.push_back(robot.newest_scan->sensor.get());
    }
    return transforms_message(robots);
}

/// Returns the scan of a channel; null if the robot's newest one is of another kind or sensor.
const mapping::IntegratedScan* scan_for(const RobotState& robot, Message message, std::uint32_t sensor) {
    const auto* scan = robot.newest_scan.get();
    const bool is_shown =
        scan != nullptr && scan->sensor->id == sensor && message_of(scan->scan, *scan->sensor) == message;
    return is_shown ? scan : nullptr;
}

std::string trail_of(const RobotState& robot) {
    const auto& trail = robot.trajectory;
    const std::size_t begin = trail.first_after(0);
    const std::size_t stride = (trail.size() - begin + kTrailPoints - 1) / kTrailPoints;
    std::vector<Pose2> poses;
    for (std::size_t n = begin; n < trail.size(); n += stride) poses.push_back(trail[n].pose);
    return path_message(poses, robot.stamp);
}

std::string path_of(const SessionView& state, RobotIndex robot) {
    std::vector<Pose2> poses;
    for (const Guided& guided : state.guided) {
        if (guided.robot != robot) continue;
        for (const Point2& point : guided.path) poses.push_back({point.x, point.y, 0.0});
    }
    return path_message(poses, state.maps->robots[robot].stamp);
}

} // namespace

void SessionFeed::receive(std::string_view message, bool is_text) {
    if (!is_text) return warn("a binary message was received; this server only shows data");
    const auto request = decode_request(message);
    if (!request) return warn(request.error().message);
    std::visit([this](const auto& each) { handle(each); }, *request);
}

void SessionFeed::handle(const Subscribe& subscribe) {
    for (const auto& [id, channel] : subscribe.wishes) {
        const std::size_t index = std::size_t{channel} - 1;
        const auto is_same = [&](const auto& each) { return each.second.channel == index; };
        if (channel == 0 || index >= advertised_) {
            warn(fmt::format("there is no channel {}", channel));
        } else if (subscriptions_.contains(id)) {
            warn(fmt::format("the subscription {} exists already", id));
        } else if (std::ranges::any_of(subscriptions_, is_same)) {
            warn(fmt::format("the channel {} is subscribed already", channel));
        } else {
            subscriptions_[id].channel = index;
        }
    }
}

void SessionFeed::handle(const Unsubscribe& unsubscribe) {
    for (const std::uint32_t id : unsubscribe.ids) {
        if (subscriptions_.erase(id) == 0) warn(fmt::format("there is no subscription {}", id));
    }
}

bool SessionFeed::wants(Content content) const {
    return std::ranges::any_of(subscriptions_,
                               [&](const auto& each) { return channels_[each.second.channel].content == content; });
}

void SessionFeed::add_channel(Channel channel) {
    const bool is_new = by_topic_.try_emplace(channel.topic, channels_.size()).second;
    if (is_new) channels_.push_back(std::move(channel));
}

void SessionFeed::add_channels(const SessionView& state) {
    if (channels_.empty()) {
        add_channel({kMapTopic, Message::kGrid, Content::kMap});
        add_channel({kTransformsTopic, Message::kTransforms, Content::kTransforms});
        add_channel({kStatusTopic, Message::kStatus, Content::kStatus});
        add_channel({kLandmarksTopic, Message::kScene, Content::kLandmarks});
        add_channel({kFrontiersTopic, Message::kScene, Content::kFrontiers});
        add_channel({kGoalsTopic, Message::kScene, Content::kGoals});
        add_channel({kPoseGraphTopic, Message::kScene, Content::kPoseGraph});
    }
    for (RobotIndex n = 0; n < state.maps->robots.size(); ++n) {
        const RobotState& robot = state.maps->robots[n];
        add_channel({pose_topic(robot.name), Message::kPose, Content::kPose, n});
        add_channel({trail_topic(robot.name), Message::kPath, Content::kTrail, n});
        add_channel({path_topic(robot.name), Message::kPath, Content::kPath, n});
        if (!robot.newest_scan) continue;
        const auto& [revision, sensor, scan] = *robot.newest_scan;
        const Message kind = foxglove::message_of(scan, *sensor);
        add_channel({scan_topic(robot.name, sensor->id, kind), kind, Content::kScan, n, sensor->id});
    }
}

std::vector<Outgoing> SessionFeed::next(const SessionView& state, Clock::time_point now) {
    std::vector<Outgoing> messages;
    if (!std::exchange(is_greeted_, true)) messages.push_back({server_info_text(session_, session_id_), true});
    add_channels(state);
    if (advertised_ < channels_.size()) {
        std::vector<Advertised> added;
        for (std::size_t n = advertised_; n < channels_.size(); ++n) {
            added.push_back({static_cast<std::uint32_t>(n + 1), channels_[n].topic, channels_[n].message});
        }
        messages.push_back({advertise_text(added), true});
        advertised_ = channels_.size();
    }
    std::ranges::move(std::exchange(answers_, {}), std::back_inserter(messages));
    look_again_ = Clock::time_point::max();
    for (auto& [id, subscription] : subscriptions_) {
        const Channel& channel = channels_[subscription.channel];
        const Version version = version_of(channel, state);
        if (subscription.sent == version) continue;
        if (now < subscription.due) {
            look_again_ = std::min(look_again_, subscription.due);
            continue;
        }
        auto message = message_of(channel, state);
        subscription.sent = version;
        if (!message) continue;
        const double stamp =
            channel.content >= Content::kPose ? state.maps->robots[channel.robot].stamp : newest_stamp(*state.maps);
        messages.push_back({data_message(id, log_time_of(stamp), *message), false});
        subscription.due = now + pause_of(channel.content);
    }
    std::ranges::move(std::exchange(answers_, {}), std::back_inserter(messages));
    return messages;
}

/// Returns the least time between two messages of a channel.
SessionFeed::Clock::duration SessionFeed::pause_of(Content content) {
    switch (content) {
    case Content::kTransforms:
    case Content::kPose:
    case Content::kScan: return Clock::duration::zero();
    case Content::kMap:
    case Content::kStatus:
    case Content::kLandmarks:
    case Content::kFrontiers:
    case Content::kGoals:
    case Content::kPoseGraph:
    case Content::kTrail:
    case Content::kPath: break;
    }
    return std::chrono::seconds(1);
}

SessionFeed::Version SessionFeed::version_of(const Channel& channel, const SessionView& state) {
    const Snapshot& maps = *state.maps;
    switch (channel.content) {
    case Content::kMap:
    case Content::kFrontiers:
    case Content::kTransforms: return {maps.revision, 0};
    case Content::kStatus: return {maps.revision, std::ranges::count(state.connected, true)};
    case Content::kLandmarks: return {state.landmarks_revision, state.landmarks ? 1 : 0};
    case Content::kGoals:
    case Content::kPath: return {state.guided_version, 0};
    case Content::kPoseGraph: return {state.graph_version, 0};
    case Content::kPose:
    case Content::kTrail: return {maps.robots[channel.robot].scan_count, maps.scan_poses.corrected()};
    case Content::kScan: {
        const auto* scan = scan_for(maps.robots[channel.robot], channel.message, channel.sensor);
        return {scan == nullptr ? 0 : scan->revision, 0};
    }
    }
    return {};
}

/// Returns the newest message of a channel; nullopt if there is nothing to show.
std::optional<std::string> SessionFeed::message_of(const Channel& channel, const SessionView& state) {
    const Snapshot& maps = *state.maps;
    switch (channel.content) {
    case Content::kMap: return map_of(maps);
    case Content::kTransforms: return transforms_of(maps);
    case Content::kStatus: return status_message(maps, state.connected, newest_stamp(maps));
    case Content::kLandmarks:
        if (!state.landmarks) return std::nullopt;
        return landmarks_message(*state.landmarks, newest_stamp(maps));
    case Content::kFrontiers: return frontiers_message(maps, newest_stamp(maps));
    case Content::kGoals: return goals_message(state, newest_stamp(maps));
    case Content::kPoseGraph:
        if (!state.graph) return std::nullopt;
        return pose_graph_message(*state.graph, newest_stamp(maps));
    case Content::kPose: {
        const RobotState& robot = maps.robots[channel.robot];
        if (!robot.pose) return std::nullopt;
        return pose_message({robot.name, robot.stamp, *robot.pose});
    }
    case Content::kScan: {
        const RobotState& robot = maps.robots[channel.robot];
        const auto* scan = scan_for(robot, channel.message, channel.sensor);
        if (scan == nullptr) return std::nullopt;
        return scan_message(sensor_frame(robot.name, *scan->sensor), scan->scan, *scan->sensor);
    }
    case Content::kTrail: return trail_of(maps.robots[channel.robot]);
    case Content::kPath: return path_of(state, channel.robot);
    }
    return std::nullopt;
}

/// Returns the whole map; nullopt if it is empty or too large, which the viewer is told once.
std::optional<std::string> SessionFeed::map_of(const Snapshot& maps) {
    const auto frame = tiles::map_frame(maps, kLayer, std::nullopt);
    const bool is_too_large =
        frame ? frame->cells.width() * frame->cells.height() > kGridCellsMax : frame.error().code == Errc::kTooLarge;
    if (is_too_large && !std::exchange(is_map_too_large_, true)) {
        warn(fmt::format("the map has more than {} million cells and is not sent as a grid; its tiles show it",
                         kGridCellsMax / 1'000'000));
    }
    if (!frame || is_too_large) return std::nullopt;
    return grid_message(maps, kLayer, *frame, newest_stamp(maps));
}

} // namespace scanloom::foxglove
