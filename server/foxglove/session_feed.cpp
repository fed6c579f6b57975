#include "server/foxglove/session_feed.hpp"

#include "server/foxglove/log_time.hpp"
#include "server/foxglove/robot_messages.hpp"
#include "server/foxglove/scene_messages.hpp"
#include "server/foxglove/status_message.hpp"
#include "server/foxglove/topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>

namespace scanloom::foxglove {
namespace {

using mapping::RobotState;
using mapping::Snapshot;

constexpr std::size_t kTrailPoints = 2'048; // of a robot, at most

std::string transforms_of(const Snapshot& maps) {
    std::vector<PlacedRobot> robots;
    for (const RobotState& robot : maps.robots) {
        if (!robot.pose) continue;
        robots.push_back({{robot.name, robot.stamp, *robot.pose}, {}});
        for (const auto& scan : robot.newest_scans) robots.back().sensors.push_back(scan->sensor.get());
    }
    return transforms_message(robots);
}

/// Returns the newest scan of a sensor; null: there is none.
const mapping::IntegratedScan* scan_of(const RobotState& robot, std::uint32_t sensor) {
    const auto found = std::ranges::find(robot.newest_scans, sensor, [](const auto& scan) { return scan->sensor->id; });
    return found == robot.newest_scans.end() ? nullptr : found->get();
}

std::string trail_of(const RobotState& robot) {
    const auto& trail = robot.trajectory;
    const std::size_t begin = trail.first_after(0);
    const std::size_t stride = (trail.size() - begin + kTrailPoints - 1) / kTrailPoints;
    std::vector<Pose2> poses;
    for (std::size_t n = begin; n < trail.size(); n += stride) poses.push_back(trail[n].pose);
    const bool ends_at_robot = trail.size() == begin || (trail.size() - 1 - begin) % stride == 0;
    if (!ends_at_robot) poses.push_back(trail[trail.size() - 1].pose);
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

void SessionFeed::warn(std::string_view text) {
    if (answers_.size() < kWarningsMax) answers_.push_back({.bytes = warning_text(text), .is_text = true});
}

void SessionFeed::handle(const Subscribe& subscribe) {
    for (const auto& [id, channel] : subscribe.subscriptions) {
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
        for (const auto& scan : robot.newest_scans) {
            const std::uint32_t sensor = scan->sensor->id;
            add_channel({scan_topic(robot.name, sensor), Message::kScan, Content::kScan, n, sensor});
        }
    }
}

std::vector<Outgoing> SessionFeed::next(const SessionView& state, Clock::time_point now) {
    std::vector<Outgoing> messages;
    const auto add_text = [&](std::string text) { messages.push_back({.bytes = std::move(text), .is_text = true}); };
    if (!std::exchange(is_greeted_, true)) add_text(server_info_text(session_, session_id_));
    add_channels(state);
    if (advertised_ < channels_.size()) {
        std::vector<Advertised> added;
        for (std::size_t n = advertised_; n < channels_.size(); ++n) {
            added.push_back({static_cast<std::uint32_t>(n + 1), channels_[n].topic, channels_[n].message});
        }
        add_text(advertise_text(added));
        advertised_ = channels_.size();
    }
    if (state.is_map_too_large && wants(Content::kMap)) warn_of_large_map();
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
        const double stamp = channel.robot ? state.maps->robots[*channel.robot].stamp : newest_stamp(*state.maps);
        messages.push_back({.bytes = data_head(id, nanoseconds_of(stamp)), .rest = std::move(message)});
        subscription.due = now + pause_of(channel.content);
    }
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
    case Content::kPoseGraph: return {state.parts_revision, 0};
    case Content::kTransforms: return {maps.revision, 0};
    case Content::kStatus: return {maps.revision, std::hash<std::vector<bool>>()(state.connected)};
    case Content::kLandmarks: return {state.landmarks_revision, state.landmarks ? 1 : 0};
    case Content::kGoals:
    case Content::kPath: return {state.guided_version, 0};
    case Content::kPose:
    case Content::kTrail: return {maps.robots[*channel.robot].scan_count, maps.scan_poses.corrected()};
    case Content::kScan: {
        const auto* scan = scan_of(maps.robots[*channel.robot], channel.sensor);
        return {scan == nullptr ? 0 : scan->revision, 0};
    }
    }
    return {};
}

/// Returns the newest message of a channel; null if there is nothing to show.
std::shared_ptr<const std::string> SessionFeed::message_of(const Channel& channel, const SessionView& state) {
    const Snapshot& maps = *state.maps;
    const auto made = [](std::string message) { return std::make_shared<const std::string>(std::move(message)); };
    switch (channel.content) {
    case Content::kMap: return state.map;
    case Content::kFrontiers: return state.frontiers;
    case Content::kTransforms: return made(transforms_of(maps));
    case Content::kStatus: return made(status_message(maps, state.connected, newest_stamp(maps)));
    case Content::kLandmarks:
        return state.landmarks ? made(landmarks_message(*state.landmarks, newest_stamp(maps))) : nullptr;
    case Content::kGoals: return made(goals_message(state, newest_stamp(maps)));
    case Content::kPoseGraph:
        return state.graph ? made(pose_graph_message(*state.graph, maps.robots.size(), newest_stamp(maps))) : nullptr;
    case Content::kPose: {
        const RobotState& robot = maps.robots[*channel.robot];
        return robot.pose ? made(pose_message({robot.name, robot.stamp, *robot.pose})) : nullptr;
    }
    case Content::kScan: {
        const RobotState& robot = maps.robots[*channel.robot];
        const auto* scan = scan_of(robot, channel.sensor);
        if (scan == nullptr) return nullptr;
        return made(scan_message(sensor_frame(robot.name, *scan->sensor), scan->scan, *scan->sensor));
    }
    case Content::kTrail: return made(trail_of(maps.robots[*channel.robot]));
    case Content::kPath: return made(path_of(state, *channel.robot));
    }
    return nullptr;
}

/// Warns once.
void SessionFeed::warn_of_large_map() {
    if (std::exchange(is_warned_, true)) return;
    warn("the map is too large to be sent as one grid; its tiles and the viewer of the server show it");
}

} // namespace scanloom::foxglove
