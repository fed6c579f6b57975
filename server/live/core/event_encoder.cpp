#include "server/live/core/event_encoder.hpp"

#include "common/scan/beam_angles.hpp"
#include "common/scan/reading.hpp"
#include "server/tiles/tile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

namespace scanloom::live {

LandmarkChanges changed_landmarks(const landmarks::LandmarkView& landmarks, LandmarkKey sent, std::size_t most) {
    LandmarkChanges changed;
    for (const auto& block : landmarks.blocks()) {
        if (block->revision < sent.last) continue;
        for (const auto& one : block->landmarks) {
            if (key_of(one) > sent) changed.first.push_back(&one);
        }
    }
    const std::size_t count = std::min(most, changed.first.size());
    const auto end = changed.first.begin() + static_cast<std::ptrdiff_t>(count);
    std::ranges::partial_sort(changed.first, end, std::less(), [](const auto* one) { return key_of(*one); });
    changed.following = changed.first.size() - count;
    changed.first.resize(count);
    return changed;
}

wire::ScanPoints points_of(const mapping::IntegratedScan& applied, std::size_t stride) {
    const Scan& scan = applied.scan;
    const Sensor& sensor = *applied.sensor;
    wire::ScanPoints out{sensor.id, sensor.kind, scan.stamp, compose(*scan.pose, sensor.mount), {}};
    const BeamAngles angles = angles_of(scan, sensor);
    const ReadingRules rules{sensor.range_min, sensor.range_max, false};
    std::size_t hits = 0;
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
        const auto reading = reading_of(scan.ranges[beam], rules);
        if (!reading || !reading->is_hit || hits++ % stride != 0) continue;
        const double direction = out.origin.yaw + beam_angle(angles, beam);
        out.points.push_back(in_millimetres(reading->metres * Point2{std::cos(direction), std::sin(direction)}));
    }
    return out;
}

namespace {

constexpr std::uint32_t kTilesAcross = 1U << tiles::kZoomNative;

wire::LiveLayer to_wire(mapping::Layer layer) noexcept {
    switch (layer) {
    case mapping::Layer::kOccupancy: return wire::LiveLayer::kOccupancy;
    case mapping::Layer::kHimm: return wire::LiveLayer::kHimm;
    case mapping::Layer::kSonar: return wire::LiveLayer::kSonar;
    case mapping::Layer::kClassification: return wire::LiveLayer::kClassification;
    }
    std::abort(); // each layer has a case
}

bool is_connected(const SessionSnapshot& snapshot, std::size_t robot) {
    return robot < snapshot.connected.size() && snapshot.connected[robot];
}

wire::LiveCounters totals_of(const SessionSnapshot& snapshot) {
    wire::LiveCounters totals;
    totals.robots = static_cast<std::uint32_t>(snapshot.maps->robots.size());
    totals.chunks = snapshot.maps->chunk_count;
    for (std::size_t n = 0; n < snapshot.maps->robots.size(); ++n) {
        totals.scans += snapshot.maps->robots[n].scan_count;
        totals.connected += is_connected(snapshot, n) ? 1 : 0;
    }
    return totals;
}

wire::TileChanges changes_of(const mapping::Snapshot& maps, mapping::Layer layer, Revision since) {
    const auto changed = tiles::changed_native_tiles(maps, layer, since);
    wire::TileChanges changes{to_wire(layer), changed.size() > kTilesMax, {}, {}};
    if (changes.everything) return changes;
    for (const auto& [key, revision] : changed) {
        changes.tiles.push_back(kTilesAcross * key.y + key.x);
        changes.revisions.push_back(revision);
    }
    return changes;
}

wire::LiveLandmark to_wire(const landmarks::MapLandmark& one) noexcept {
    const auto& landmark = one.landmark;
    return {one.id,
            landmark.position.x,
            landmark.position.y,
            one.seen,
            static_cast<float>(landmark.size.x),
            static_cast<float>(landmark.size.y),
            static_cast<float>(landmark.spread),
            static_cast<float>(landmark.continuity),
            static_cast<std::uint32_t>(landmark.points),
            one.first,
            one.last};
}

/// @return nullopt for a robot that sends poses in the map frame
std::optional<wire::LiveLocalization> localization_of(const mapping::RobotState& robot) {
    if (robot.poses == Poses::kMap) return std::nullopt;
    const auto& known = robot.localization;
    return wire::LiveLocalization{known.state,
                                  robot.poses,
                                  static_cast<float>(known.inlier_ratio),
                                  static_cast<float>(known.position_sigma),
                                  static_cast<float>(known.yaw_sigma),
                                  static_cast<float>(known.mount_yaw_error.value_or(0.0))};
}

/// Returns whether a viewer would show both in the same words: to 5 % of the points, 1 cm and half a degree, of the
/// mount 10 degrees.
bool are_similar(const std::optional<wire::LiveLocalization>& a, const std::optional<wire::LiveLocalization>& b) {
    constexpr float kPerInlierStep = 20.0F;
    constexpr float kPerMetre = 100.0F;
    constexpr float kPerRadian = 115.0F;
    constexpr float kPerMountError = 5.7F;
    const auto are_near = [](float left, float right, float steps) {
        return std::round(left * steps) == std::round(right * steps);
    };
    if (!a || !b) return a.has_value() == b.has_value();
    return a->state == b->state && a->poses == b->poses && are_near(a->inliers, b->inliers, kPerInlierStep) &&
           are_near(a->sigma_m, b->sigma_m, kPerMetre) && are_near(a->sigma_rad, b->sigma_rad, kPerRadian) &&
           are_near(a->mount_yaw_error, b->mount_yaw_error, kPerMountError);
}

/// Pre: the pose is within kCoordinateMax.
PointMm point_of(const Pose2& pose) { return in_millimetres({pose.x, pose.y}); }

} // namespace

Subscription subscription_of(const wire::LiveRequest& request) noexcept {
    Subscription subscription{{}, request.points, request.landmarks};
    for (const mapping::Layer layer : mapping::kLayers) {
        subscription.layers[static_cast<std::size_t>(layer)] =
            std::ranges::find(request.layers, to_wire(layer)) != request.layers.end();
    }
    return subscription;
}

void EventEncoder::set_subscription(const Subscription& subscription) {
    subscription_ = subscription;
    for (auto& robot : sent_robots_) robot.scan = 0;
}

std::optional<wire::LiveEvent> EventEncoder::next(const SessionSnapshot& snapshot) {
    const mapping::Snapshot& maps = *snapshot.maps;
    const Revision corrected = maps.scan_poses.corrected();
    if (sent_ && sent_->poses_corrected != corrected) sent_robots_.clear(); // their trails and newest scans have moved
    wire::LiveEvent event;
    add_tiles(maps, event);
    add_robots(snapshot, event);
    add_landmarks(snapshot, event);
    const SentSession now{maps.revision, snapshot.state, snapshot.goals_revision, corrected, maps.moving_scans};
    if (sent_ == now && event.tiles.empty() && event.robots.empty() && !event.landmarks) return std::nullopt;
    sent_ = now;
    event.session = session_;
    event.revision = maps.revision;
    event.state = snapshot.state;
    event.reason = snapshot.reason;
    event.counters = totals_of(snapshot);
    event.frontiers_revision = maps.classes.newest({});
    event.goals_revision = snapshot.goals_revision;
    event.poses_corrected = corrected;
    event.moving_scans = maps.moving_scans;
    return event;
}

void EventEncoder::add_tiles(const mapping::Snapshot& maps, wire::LiveEvent& event) {
    for (const mapping::Layer layer : mapping::kLayers) {
        const auto index = static_cast<std::size_t>(layer);
        if (!subscription_.layers[index] || sent_layers_[index] == maps.revision) continue;
        auto changes = changes_of(maps, layer, std::exchange(sent_layers_[index], maps.revision));
        if (changes.everything || !changes.tiles.empty()) event.tiles.push_back(std::move(changes));
    }
}

void EventEncoder::add_landmarks(const SessionSnapshot& snapshot, wire::LiveEvent& event) {
    if (!subscription_.landmarks || !snapshot.landmarks) return;
    const FoundLandmarks& found = *snapshot.landmarks;
    const LandmarkChanges changed = changed_landmarks(found.state.landmarks, sent_landmarks_.up_to, kLandmarksMax);
    sent_landmarks_.following = changed.following;
    if (changed.first.empty() && sent_landmarks_.refused == found.refused) return;
    if (!changed.first.empty()) sent_landmarks_.up_to = key_of(*changed.first.back());
    sent_landmarks_.refused = found.refused;
    auto& changes = event.landmarks.emplace();
    for (const auto* one : changed.first) changes.landmarks.push_back(to_wire(*one));
    changes.following = changed.following;
    changes.captures = found.state.captures;
    changes.revision = found.revision;
    changes.refused = found.refused;
}

bool EventEncoder::shows_scan(const mapping::RobotState& robot, const SentRobot& sent) const {
    return subscription_.points && robot.newest_scan && robot.newest_scan->revision > sent.scan;
}

bool EventEncoder::has_changed(const mapping::RobotState& robot, bool connected, const SentRobot& sent) const {
    return !sent.known || sent.connected != connected || sent.body_radius != robot.body_radius ||
           sent.scan_count != robot.scan_count || shows_scan(robot, sent) ||
           !are_similar(sent.localization, localization_of(robot));
}

/// Returns the stride with which all scans of the event together have at most kScanPointsMax points, or one point each.
std::size_t EventEncoder::stride_for(const mapping::Snapshot& maps) const {
    std::size_t beams = 0;
    for (std::size_t n = 0; n < maps.robots.size(); ++n) {
        if (shows_scan(maps.robots[n], sent_robots_[n])) beams += maps.robots[n].newest_scan->scan.ranges.size();
    }
    return std::max<std::size_t>(1, (beams + kScanPointsMax - 1) / kScanPointsMax);
}

void EventEncoder::add_robots(const SessionSnapshot& snapshot, wire::LiveEvent& event) {
    const auto& robots = snapshot.maps->robots;
    sent_robots_.resize(robots.size());
    const std::size_t stride = stride_for(*snapshot.maps);
    std::size_t moved = 0;
    for (std::size_t n = 0; n < robots.size(); ++n)
        moved += robots[n].trajectory.size() > sent_robots_[n].trail ? 1 : 0;
    const std::size_t trail_max = std::clamp<std::size_t>(kTrailsMax / std::max<std::size_t>(1, moved), 1, kTrailMax);

    for (std::size_t n = 0; n < robots.size(); ++n) {
        const mapping::RobotState& robot = robots[n];
        const bool connected = is_connected(snapshot, n);
        SentRobot& sent = sent_robots_[n];
        if (!has_changed(robot, connected, sent)) continue;
        auto& update = event.robots.emplace_back(wire::RobotUpdate{static_cast<std::uint32_t>(n),
                                                                   robot.name,
                                                                   connected,
                                                                   robot.pose,
                                                                   robot.stamp,
                                                                   robot.scan_count,
                                                                   robot.last_seq,
                                                                   {},
                                                                   0,
                                                                   {},
                                                                   robot.body_radius,
                                                                   localization_of(robot)});
        const auto& trail = robot.trajectory;
        const std::size_t first =
            std::max({sent.trail, trail.begin(), trail.size() - std::min(trail.size(), trail_max)});
        update.trail_from = first;
        for (std::size_t i = first; i < trail.size(); ++i) update.trail.push_back(point_of(trail[i].pose));
        if (shows_scan(robot, sent)) {
            update.scan = points_of(*robot.newest_scan, stride);
            sent.scan = robot.newest_scan->revision;
        }
        sent.known = true;
        sent.connected = connected;
        sent.body_radius = robot.body_radius;
        sent.localization = update.localization;
        sent.scan_count = robot.scan_count;
        sent.trail = trail.size();
    }
}

} // namespace scanloom::live
