#include "server/live/core/narrator.hpp"

#include "server/live/core/scan_points.hpp"
#include "server/tiles/tile.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::live {
namespace {

constexpr std::uint32_t kTilesAcross = 1U << tiles::kZoomNative;

wire::LiveLayer to_wire(mapping::Layer layer) noexcept {
    switch (layer) {
    case mapping::Layer::kHimm: return wire::LiveLayer::kHimm;
    case mapping::Layer::kSonar: return wire::LiveLayer::kSonar;
    case mapping::Layer::kClassification: return wire::LiveLayer::kClassification;
    case mapping::Layer::kOccupancy: break;
    }
    return wire::LiveLayer::kOccupancy;
}

bool is_connected(const Moment& moment, std::size_t robot) {
    return robot < moment.connected.size() && moment.connected[robot];
}

wire::LiveCounters totals_of(const Moment& moment) {
    wire::LiveCounters totals;
    totals.robots = static_cast<std::uint32_t>(moment.maps->robots.size());
    totals.chunks = moment.maps->chunk_count;
    for (std::size_t n = 0; n < moment.maps->robots.size(); ++n) {
        totals.scans += moment.maps->robots[n].scan_count;
        totals.connected += is_connected(moment, n) ? 1 : 0;
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

/// Pre: the pose is within kCoordinateMax.
PointMm point_of(const Pose2& pose) { return in_millimetres({pose.x, pose.y}); }

} // namespace

Wishes wishes_of(const wire::LiveRequest& request) noexcept {
    Wishes wishes{{}, request.points, request.landmarks};
    for (const mapping::Layer layer : mapping::kLayers) {
        wishes.layers[static_cast<std::size_t>(layer)] =
            std::ranges::find(request.layers, to_wire(layer)) != request.layers.end();
    }
    return wishes;
}

void Narrator::set_wishes(const Wishes& wishes) {
    wishes_ = wishes;
    for (auto& robot : told_robots_) robot.scan = 0;
}

std::optional<wire::LiveEvent> Narrator::next(const Moment& moment) {
    const mapping::Snapshot& maps = *moment.maps;
    wire::LiveEvent event;
    tell_tiles(maps, event);
    tell_robots(moment, event);
    tell_landmarks(moment, event);
    const ToldSession now{maps.revision, moment.state, moment.goals_revision};
    if (told_ == now && event.tiles.empty() && event.robots.empty() && !event.landmarks) return std::nullopt;
    told_ = now;
    event.session = session_;
    event.revision = maps.revision;
    event.state = moment.state;
    event.reason = moment.reason;
    event.counters = totals_of(moment);
    event.frontiers_revision = maps.classes.newest({});
    event.goals_revision = moment.goals_revision;
    return event;
}

void Narrator::tell_tiles(const mapping::Snapshot& maps, wire::LiveEvent& event) {
    for (const mapping::Layer layer : mapping::kLayers) {
        const auto index = static_cast<std::size_t>(layer);
        if (!wishes_.layers[index] || told_layers_[index] == maps.revision) continue;
        auto changes = changes_of(maps, layer, std::exchange(told_layers_[index], maps.revision));
        if (changes.everything || !changes.tiles.empty()) event.tiles.push_back(std::move(changes));
    }
}

void Narrator::tell_landmarks(const Moment& moment, wire::LiveEvent& event) {
    if (!wishes_.landmarks || !moment.landmarks) return;
    const FoundLandmarks& found = *moment.landmarks;
    const LandmarkNews news = news_in(found.state.landmarks, told_landmarks_.up_to, kLandmarksMax);
    told_landmarks_.following = news.following;
    if (news.first.empty() && told_landmarks_.refused == found.refused) return;
    if (!news.first.empty()) told_landmarks_.up_to = place_of(*news.first.back());
    told_landmarks_.refused = found.refused;
    auto& changes = event.landmarks.emplace();
    for (const auto* one : news.first) changes.landmarks.push_back(to_wire(*one));
    changes.following = news.following;
    changes.captures = found.state.captures;
    changes.revision = found.revision;
    changes.refused = found.refused;
}

bool Narrator::shows_scan(const mapping::RobotState& robot, const ToldRobot& told) const {
    return wishes_.points && robot.newest_scan && robot.newest_scan->revision > told.scan;
}

bool Narrator::is_news(const mapping::RobotState& robot, bool connected, const ToldRobot& told) const {
    return !told.known || told.connected != connected || told.body_radius != robot.body_radius ||
           told.scan_count != robot.scan_count || shows_scan(robot, told);
}

/// Returns the stride with which all scans of the event together have at most kScanPointsMax points, or one point each.
std::size_t Narrator::stride_for(const mapping::Snapshot& maps) const {
    std::size_t beams = 0;
    for (std::size_t n = 0; n < maps.robots.size(); ++n) {
        if (shows_scan(maps.robots[n], told_robots_[n])) beams += maps.robots[n].newest_scan->scan.ranges.size();
    }
    return std::max<std::size_t>(1, (beams + kScanPointsMax - 1) / kScanPointsMax);
}

void Narrator::tell_robots(const Moment& moment, wire::LiveEvent& event) {
    const auto& robots = moment.maps->robots;
    told_robots_.resize(robots.size());
    const std::size_t stride = stride_for(*moment.maps);
    std::size_t moved = 0;
    for (std::size_t n = 0; n < robots.size(); ++n)
        moved += robots[n].trajectory.size() > told_robots_[n].trail ? 1 : 0;
    const std::size_t trail_max = std::clamp<std::size_t>(kTrailsMax / std::max<std::size_t>(1, moved), 1, kTrailMax);

    for (std::size_t n = 0; n < robots.size(); ++n) {
        const mapping::RobotState& robot = robots[n];
        const bool connected = is_connected(moment, n);
        ToldRobot& told = told_robots_[n];
        if (!is_news(robot, connected, told)) continue;
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
                                                                   robot.body_radius});
        const auto& trail = robot.trajectory;
        const std::size_t first =
            std::max({told.trail, trail.begin(), trail.size() - std::min(trail.size(), trail_max)});
        update.trail_from = first;
        for (std::size_t i = first; i < trail.size(); ++i) update.trail.push_back(point_of(trail[i].pose));
        if (shows_scan(robot, told)) {
            update.scan = points_of(*robot.newest_scan, stride);
            told.scan = robot.newest_scan->revision;
        }
        told.known = true;
        told.connected = connected;
        told.body_radius = robot.body_radius;
        told.scan_count = robot.scan_count;
        told.trail = trail.size();
    }
}

} // namespace scanloom::live
