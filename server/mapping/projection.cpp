#include "server/mapping/projection.hpp"

#include "server/mapping/reach.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scanloom::mapping {
namespace {

constexpr double kReachCellsMax = 8192.0;

Error misplaced(Revision revision, std::string what) {
    return {Errc::kMalformed, fmt::format("log entry {}: {}; the log is damaged", revision, what)};
}

} // namespace

Projection::Projection(const MapConfig& config) : config_(config), occupancy_(config) {}

Result<> Projection::fold(const LogEntry& entry) {
    double unbounded = HUGE_VAL;
    if (auto folded = fold(entry, unbounded); !folded) return folded.error();
    return {};
}

Result<bool> Projection::fold(const LogEntry& entry, double& work) {
    auto folded = std::visit([&](const auto& body) { return fold_entry(body, work); }, entry);
    if (folded && *folded) ++revision_;
    return folded;
}

Result<bool> Projection::fold_entry(const RobotJoined& joined, double&) {
    const bool again = joined.robot < robots_.size() && robots_[joined.robot].state.name == joined.name &&
                       robots_[joined.robot].state.last_seq == 0;
    if (joined.robot != robots_.size() && !again) {
        return misplaced(revision_ + 1, fmt::format("robot {} joins after {} others", joined.robot, robots_.size()));
    }
    if (!again) robots_.emplace_back().state.name = joined.name;
    robots_[joined.robot].source = joined.source;
    return true;
}

Result<bool> Projection::fold_entry(const SensorDescribed& described, double&) {
    if (described.robot >= robots_.size()) {
        return misplaced(revision_ + 1, fmt::format("a sensor of robot {}, which never joined", described.robot));
    }
    auto& robot = robots_[described.robot];
    robot.sensors[described.sensor.id] = {revision_ + 1, std::make_shared<const Sensor>(described.sensor)};
    robot.fans.erase(described.sensor.id);
    return true;
}

Result<bool> Projection::fold_entry(const ScanTaken& taken, double& work) {
    const Revision revision = revision_ + 1;
    if (taken.robot >= robots_.size()) {
        return misplaced(revision, fmt::format("a scan of robot {}, which never joined", taken.robot));
    }
    auto& robot = robots_[taken.robot];
    const auto& scan = taken.scan;
    const auto known = robot.sensors.find(scan.sensor);
    if (known == robot.sensors.end()) {
        return misplaced(revision, fmt::format("a scan of sensor {}, which was never described", scan.sensor));
    }
    if (scan.seq != robot.state.last_seq + 1) {
        return misplaced(revision, fmt::format("scan {} of robot '{}' follows scan {}", scan.seq, robot.state.name,
                                               robot.state.last_seq));
    }
    const Sensor& sensor = *known->second.sensor;
    if (sensor.kind == SensorKind::kLaser && !integrate(robot, sensor, scan, work)) return false;
    robot.state.last_seq = scan.seq;
    robot.state.scan_count += 1;
    robot.state.stamp = scan.stamp;
    robot.state.pose = scan.pose;
    robot.trajectory.append({revision, scan.stamp, scan.pose});
    return true;
}

/// @return whether all sectors of the scan are in.
bool Projection::integrate(Robot& robot, const Sensor& sensor, const Scan& scan, double& work) {
    const ModelGeometry geometry = geometry_of(config_, sensor);
    const auto missing = std::span(fan_of(robot, sensor, scan)).subspan(sectors_in_);
    const auto sectors = missing.first(sectors_within(work, missing, scan.ranges, geometry));
    bounds_.include(
        occupancy_.integrate(sectors, scan.ranges, compose(scan.pose, sensor.mount), geometry, revision_ + 1));
    const bool complete = sectors.size() == missing.size();
    sectors_in_ = complete ? 0 : sectors_in_ + sectors.size();
    return complete;
}

const BeamFan& Projection::fan_of(Robot& robot, const Sensor& sensor, const Scan& scan) {
    auto& known = robot.fans[sensor.id];
    if (sectors_in_ > 0) return known.fan;
    if (scan.angles || known.beams != scan.ranges.size()) {
        const double aperture = sensor.aperture > 0.0 ? sensor.aperture : config_.beam_aperture;
        known.fan = make_beam_fan(angles_of(scan, sensor), aperture);
        known.beams = scan.angles ? 0 : scan.ranges.size();
    }
    return known.fan;
}

Snapshot Projection::snapshot() {
    Snapshot snapshot{revision_, config_, bounds_, occupancy_.snapshot(), {}};
    snapshot.robots.reserve(robots_.size());
    for (const auto& robot : robots_) {
        snapshot.robots.push_back(robot.state);
        snapshot.robots.back().trajectory = robot.trajectory.snapshot();
    }
    return snapshot;
}

ProjectionState Projection::state() const {
    ProjectionState state{revision_, bounds_, {}};
    for (const auto& robot : robots_) {
        auto& out = state.robots.emplace_back(
            ProjectionState::Robot{robot.state.name, robot.source, robot.state.last_seq, robot.state.scan_count, {}});
        for (const auto& [id, known] : robot.sensors) out.sensors.push_back(known);
    }
    return state;
}

void Projection::restore(const ProjectionState& state) {
    revision_ = state.revision;
    bounds_ = state.bounds;
    for (const auto& saved : state.robots) {
        auto& robot = robots_.emplace_back();
        robot.state.name = saved.name;
        robot.source = saved.source;
        robot.state.last_seq = saved.last_seq;
        robot.state.scan_count = saved.scan_count;
        for (const auto& known : saved.sensors) robot.sensors[known.sensor->id] = known;
    }
}

void Projection::restore_chunk(grid::ChunkKey key, Revision revision, std::span<const LogOdds> cells) {
    occupancy_.restore(key, revision, cells);
}

Result<> Projection::restore_point(RobotIndex robot, const TrajectoryPoint& point) {
    if (point.revision > revision_) return {}; // comes again with its scan
    if (robot >= robots_.size())
        return misplaced(point.revision, fmt::format("a pose of robot {}, which never joined", robot));
    robots_[robot].trajectory.append(point);
    robots_[robot].state.stamp = point.stamp;
    robots_[robot].state.pose = point.pose;
    return {};
}

Result<> check_reach(const MapConfig& config, const Sensor& sensor) {
    if (sensor.range_max <= kReachCellsMax * config.cell_size) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("range_max is {} metres, more than {} cells of {} metres; use larger cells, or state the "
                             "range that is wanted in the map",
                             sensor.range_max, kReachCellsMax, config.cell_size)};
}

} // namespace scanloom::mapping
