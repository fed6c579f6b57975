#include "common/wire/live.hpp"

#include "common/wire/proto_convert.hpp"

#include "scanloom/v1/live.pb.h"

#include <fmt/format.h>
#include <google/protobuf/arena.h>
#include <google/protobuf/unknown_field_set.h>

namespace scanloom::wire {
namespace {

constexpr int kLayersMax = 16; // four, and some more for a viewer that sends duplicates

void write(const TileChanges& changes, v1::TileChanges& out) {
    out.set_layer(static_cast<v1::Layer>(changes.layer));
    out.set_everything(changes.everything);
    out.mutable_tiles()->Add(changes.tiles.begin(), changes.tiles.end());
    out.mutable_revisions()->Add(changes.revisions.begin(), changes.revisions.end());
}

void write(const ScanPoints& scan, v1::ScanPoints& out) {
    out.set_sensor(scan.sensor);
    out.set_kind(scan.kind == SensorKind::kSonar ? v1::SENSOR_KIND_SONAR : v1::SENSOR_KIND_LASER);
    out.set_stamp(scan.stamp);
    to_proto(scan.origin, *out.mutable_origin());
    append_differences(scan.points, *out.mutable_points());
}

void write(const LiveLocalization& localization, v1::RobotLocalization& out) {
    out.set_state(static_cast<v1::LocalizationState>(localization.state));
    out.set_poses(static_cast<v1::Poses>(localization.poses));
    out.set_inliers(localization.inliers);
    out.set_sigma_m(localization.sigma_m);
    out.set_sigma_rad(localization.sigma_rad);
    out.set_mount_yaw_error(localization.mount_yaw_error);
}

void write(const RobotUpdate& robot, v1::RobotUpdate& out) {
    out.set_robot(robot.robot);
    out.set_name(robot.name);
    out.set_connected(robot.connected);
    if (robot.pose) to_proto(*robot.pose, *out.mutable_pose());
    out.set_stamp(robot.stamp);
    out.set_scan_count(robot.scan_count);
    out.set_last_seq(robot.last_seq);
    append_differences(robot.trail, *out.mutable_trail());
    out.set_trail_from(robot.trail_from);
    if (robot.scan) write(*robot.scan, *out.mutable_scan());
    out.set_body_radius(robot.body_radius.value_or(0.0));
    if (robot.localization) write(*robot.localization, *out.mutable_localization());
}

void write(const LandmarkChanges& changes, v1::LandmarkChanges& out) {
    for (const auto& landmark : changes.landmarks) {
        auto& one = *out.add_landmarks();
        one.set_id(landmark.id);
        one.set_x(landmark.x);
        one.set_y(landmark.y);
        one.set_seen(landmark.seen);
        one.set_size_x(landmark.size_x);
        one.set_size_y(landmark.size_y);
        one.set_spread(landmark.spread);
        one.set_continuity(landmark.continuity);
        one.set_points(landmark.points);
        one.set_first(landmark.first);
        one.set_last(landmark.last);
    }
    out.set_following(changes.following);
    out.set_captures(changes.captures);
    out.set_revision(changes.revision);
    out.set_refused(changes.refused);
}

} // namespace

std::string encode(const LiveEvent& event) {
    google::protobuf::Arena arena;
    auto& out = *google::protobuf::Arena::CreateMessage<v1::LiveEvent>(&arena);
    out.set_session(event.session);
    out.set_revision(event.revision);
    out.set_state(static_cast<v1::SessionState>(event.state));
    out.set_reason(event.reason);
    auto& counters = *out.mutable_counters();
    counters.set_scans(event.counters.scans);
    counters.set_robots(event.counters.robots);
    counters.set_connected(event.counters.connected);
    counters.set_chunks(event.counters.chunks);
    out.set_frontiers_revision(event.frontiers_revision);
    for (const auto& changes : event.tiles) write(changes, *out.add_tiles());
    for (const auto& robot : event.robots) write(robot, *out.add_robots());
    out.set_goals_revision(event.goals_revision);
    if (event.landmarks) write(*event.landmarks, *out.mutable_landmarks());
    out.set_poses_corrected(event.poses_corrected);
    out.set_moving_scans(event.moving_scans);
    return out.SerializeAsString();
}

Result<LiveRequest> decode_live_request(std::string_view body) {
    google::protobuf::Arena arena;
    auto& proto = *google::protobuf::Arena::CreateMessage<v1::LiveRequest>(&arena);
    if (!proto.ParseFromArray(body.data(), static_cast<int>(body.size()))) {
        return Error{Errc::kMalformed, "this is no LiveRequest; see live.proto"};
    }
    const auto& unknown = v1::LiveRequest::GetReflection()->GetUnknownFields(proto);
    if (!unknown.empty()) {
        return invalid_field(fmt::format("live_request has a field {}, which is not known here; see live.proto",
                                         unknown.field(0).number()));
    }
    if (proto.layers_size() > kLayersMax) {
        return Error{Errc::kTooLarge, fmt::format("live_request.layers has {} entries, at most {} are read",
                                                  proto.layers_size(), kLayersMax)};
    }
    LiveRequest request;
    request.points = proto.points();
    request.landmarks = proto.landmarks();
    for (const int layer : proto.layers()) {
        if (layer == v1::LAYER_UNSPECIFIED || !v1::Layer_IsValid(layer)) {
            return invalid_field(
                fmt::format("live_request.layers[{}] is {}, which is no layer", request.layers.size(), layer));
        }
        request.layers.push_back(static_cast<LiveLayer>(layer));
    }
    return request;
}

} // namespace scanloom::wire
