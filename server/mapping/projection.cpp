#include "server/mapping/projection.hpp"

#include "server/mapping/reach.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

namespace scanloom::mapping {
namespace {

Error misplaced(Revision revision, std::string what) {
    return {Errc::kMalformed, fmt::format("log entry {}: {}; the log is damaged", revision, what)};
}

} // namespace

Projection::Projection(const MapConfig& config, SharedExclusions exclusions)
    : Projection(config, std::move(exclusions), LaserLayers(config), SonarLayer(config),
                 classify::ClassLayer(danger_reach(config))) {}

Projection::Projection(const MapConfig& config, SharedExclusions exclusions, LaserLayers laser, SonarLayer sonar,
                       classify::ClassLayer classes)
    : config_(config), laser_(std::move(laser)), sonar_(std::move(sonar)), classes_(std::move(classes)),
      filter_(config.max_jump, std::move(exclusions)) {}

const std::string* Projection::find_robot_name(RobotIndex robot) const noexcept {
    return robot < robots_.size() ? &robots_[robot].state.name : nullptr;
}

const Sensor* Projection::find_sensor(RobotIndex robot, std::uint32_t id) const noexcept {
    if (robot >= robots_.size()) return nullptr;
    const auto known = robots_[robot].sensors.find(id);
    return known == robots_[robot].sensors.end() ? nullptr : known->second.sensor.get();
}

std::shared_ptr<const Sensor> Projection::sensor_of(RobotIndex robot, std::uint32_t id) const {
    if (robot >= robots_.size()) return nullptr;
    const auto known = robots_[robot].sensors.find(id);
    return known == robots_[robot].sensors.end() ? nullptr : known->second.sensor;
}

bool Projection::is_outdated_by(const LogEntry& entry) const noexcept {
    const bool is_exclusion =
        std::holds_alternative<ScansExcluded>(entry) || std::holds_alternative<ExclusionLifted>(entry);
    return is_exclusion && exclusions()->revision() <= revision_;
}

Result<> Projection::fold(const LogEntry& entry) {
    double unbounded = HUGE_VAL;
    if (auto folded = fold(entry, unbounded); !folded) return folded.error();
    return {};
}

Result<bool> Projection::fold(const LogEntry& entry, double& work) {
    if (is_outdated_by(entry)) {
        return Error{Errc::kConflict,
                     fmt::format("log entry {} changes which of the earlier scans are integrated; fold "
                                 "the log from its beginning with its exclusions",
                                 revision_ + 1)};
    }
    auto folded = std::visit([&](const auto& body) { return fold_entry(body, work); }, entry);
    if (folded && *folded) ++revision_;
    return folded;
}

Result<bool> Projection::fold_entry(const RobotJoined& joined, double&) {
    const bool again = joined.robot < robots_.size() && robots_[joined.robot].state.name == joined.name &&
                       (robots_[joined.robot].state.last_seq == 0 || robots_[joined.robot].source == joined.source);
    if (joined.robot != robots_.size() && !again) {
        return misplaced(revision_ + 1, fmt::format("robot {} joins after {} others", joined.robot, robots_.size()));
    }
    if (!again) robots_.emplace_back().state.name = joined.name;
    robots_[joined.robot].source = joined.source;
    robots_[joined.robot].state.body_radius = joined.body_radius;
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
    const ScanUse use = filter_.use_of(revision, scan_pose_of(taken));
    if (use == ScanUse::kIntegrated && !integrate(robot, sensor, scan, work)) return false;
    filter_.take(revision, scan_pose_of(taken));
    robot.state.last_seq = scan.seq;
    if (use == ScanUse::kExcluded) ++robot.state.excluded;
    if (use != ScanUse::kIntegrated) return true;
    robot.state.scan_count += 1;
    robot.newest = {revision, scan.stamp, scan.pose};
    robot.trajectory.append(*robot.newest);
    return true;
}

Result<bool> Projection::fold_entry(const MapPatch& patch, double& work) {
    if (!robots_.empty()) return misplaced(revision_ + 1, "an imported map after robots have joined");
    work -= reach_of(config_, patch).work;
    laser_.import(patch, revision_ + 1);
    return true;
}

/// Its scans were left out when their turn came.
Result<bool> Projection::fold_entry(const ScansExcluded& excluded, double&) {
    if (excluded.robot < robots_.size()) return true;
    return misplaced(revision_ + 1, fmt::format("scans of robot {} are excluded, which never joined", excluded.robot));
}

Result<bool> Projection::fold_entry(const ExclusionLifted&, double&) { return true; }

/// @return whether all of the scan is in.
bool Projection::integrate(Robot& robot, const Sensor& sensor, const Scan& scan, double& work) {
    const auto& fan = fan_of(robot, sensor, scan).fan;
    const Pose2 T_map_sensor = compose(scan.pose, sensor.mount);
    const ReadingRules readings{sensor.range_min, sensor.range_max, config_.drop_no_return};
    const bool complete =
        sensor.kind == SensorKind::kLaser
            ? laser_.integrate({std::get<LaserFan>(fan), scan.ranges, T_map_sensor, readings}, revision_ + 1, work)
            : sonar_.integrate({std::get<SonarFan>(fan), scan.ranges, T_map_sensor, readings}, revision_ + 1, work);
    is_folding_ = !complete;
    return complete;
}

const Projection::KnownFan& Projection::fan_of(Robot& robot, const Sensor& sensor, const Scan& scan) {
    auto& known = robot.fans[sensor.id];
    if (is_folding_) return known;
    if (scan.angles || known.beams != scan.ranges.size()) {
        const BeamAngles angles = angles_of(scan, sensor);
        if (sensor.kind == SensorKind::kLaser) {
            known.fan = make_laser_fan(config_, angles, sensor.aperture);
        } else {
            known.fan = make_sonar_fan(config_, angles, sensor.aperture);
        }
        known.beams = scan.angles ? 0 : scan.ranges.size();
    }
    return known;
}

std::size_t Projection::page_count() const noexcept {
    std::size_t blocks = 0;
    for (const auto& robot : robots_) blocks += robot.trajectory.block_count();
    return chunk_count() + blocks;
}

Snapshot Projection::snapshot() {
    Snapshot snapshot{.revision = revision_,
                      .config = config_,
                      .exclusions = filter_.exclusions(),
                      .bounds = bounds(),
                      .chunk_count = chunk_count(),
                      .laser = laser_.snapshot(),
                      .sonar = sonar_.snapshot()};
    bring_classes_up_to(snapshot.laser);
    snapshot.classes = classes_.snapshot();
    snapshot.robots.reserve(robots_.size());
    for (const auto& robot : robots_) {
        auto& state = snapshot.robots.emplace_back(robot.state);
        state.jumps = filter_.jumps().state(static_cast<RobotIndex>(snapshot.robots.size() - 1)).left_out;
        state.trajectory = robot.trajectory.snapshot();
        if (!robot.newest) continue;
        state.stamp = robot.newest->stamp;
        state.pose = robot.newest->pose;
    }
    return snapshot;
}

/// Cost  the chunks that changed since the last time, and their neighbours.
void Projection::bring_classes_up_to(const LaserView& laser) {
    std::vector<grid::ChunkKey> changed;
    const Revision newest = std::max(revision_, laser.newest({})); // chunks of a checkpoint may be newer than its state
    laser.visit({}, classes_at_, [&](grid::ChunkKey key, const LaserChunk&) { changed.push_back(key); });
    const auto types_of = [&](grid::ChunkKey key) {
        const LaserChunk* chunk = laser.find(key);
        return chunk == nullptr ? nullptr : &chunk->occ_types;
    };
    classes_.update(changed, types_of, newest);
    classes_at_ = revision_;
}

Projection Projection::branch() {
    assert(!is_folding_);
    Projection other(config_, filter_.exclusions(), laser_.branch(), sonar_.branch(), classes_.branch());
    other.revision_ = revision_;
    other.classes_at_ = classes_at_;
    other.robots_.reserve(robots_.size());
    for (const auto& robot : robots_) other.robots_.push_back(robot.branch());
    other.filter_ = filter_;
    return other;
}

/// Without the fans, which are made again when they are needed.
Projection::Robot Projection::Robot::branch() const {
    return {state, source, newest, trajectory.branch(), sensors, {}};
}

ProjectionState Projection::state() const {
    ProjectionState state{revision_, bounds(), chunk_count(), {}, filter_.exclusions()};
    for (RobotIndex index = 0; index < robots_.size(); ++index) {
        const Robot& robot = robots_[index];
        auto& out = state.robots.emplace_back(ProjectionState::Robot{robot.state.name,
                                                                     robot.source,
                                                                     robot.state.body_radius,
                                                                     robot.state.last_seq,
                                                                     robot.state.scan_count,
                                                                     robot.newest,
                                                                     filter_.jumps().state(index),
                                                                     robot.state.excluded,
                                                                     {}});
        for (const auto& [id, known] : robot.sensors) out.sensors.push_back(known);
        if (robot.newest) state.pages += 1; // what restore() keeps of its path
    }
    return state;
}

void Projection::restore(const ProjectionState& state) {
    revision_ = state.revision;
    filter_ = ScanFilter(config_.max_jump, state.exclusions);
    laser_.restore(state.bounds.laser);
    sonar_.restore(state.bounds.sonar);
    for (const auto& saved : state.robots) {
        auto& robot = robots_.emplace_back();
        robot.state.name = saved.name;
        robot.source = saved.source;
        robot.state.body_radius = saved.body_radius;
        robot.state.last_seq = saved.last_seq;
        robot.state.scan_count = saved.scan_count;
        robot.newest = saved.newest;
        const bool has_point = saved.newest && saved.scan_count > 0; // the newest one; those before are in the log
        robot.trajectory = Trajectory(saved.scan_count - (has_point ? 1 : 0));
        if (has_point) robot.trajectory.append(*saved.newest);
        for (const auto& known : saved.sensors) robot.sensors[known.sensor->id] = known;
        robot.state.excluded = saved.excluded;
        auto& jumps = filter_.jumps();
        if (jumps.is_on()) jumps.restore(static_cast<RobotIndex>(robots_.size() - 1), saved.jumps);
    }
}

LaserChunk& Projection::restore_laser_chunk(grid::ChunkKey key, Revision revision) {
    return laser_.restore(key, revision);
}

SonarChunk& Projection::restore_sonar_chunk(grid::ChunkKey key, Revision revision) {
    return sonar_.restore(key, revision);
}

} // namespace scanloom::mapping
