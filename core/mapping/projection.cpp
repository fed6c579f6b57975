#include "core/mapping/projection.hpp"

#include "core/mapping/reach.hpp"
#include "core/scan_matching/deskew.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

namespace scanloom::mapping {

Projection::Projection(const MapConfig& config, SharedExclusions exclusions, Revision corrected)
    : Projection(config, std::move(exclusions), LaserLayers(config), SonarLayer(config),
                 classify::ClassLayer(danger_reach(config))) {
    corrected_ = corrected;
}

Projection::Projection(const MapConfig& config, SharedExclusions exclusions, LaserLayers laser, SonarLayer sonar,
                       classify::ClassLayer classes)
    : config_(config), laser_(std::move(laser)), sonar_(std::move(sonar)), classes_(std::move(classes)),
      filter_(config.max_jump, std::move(exclusions)) {}

std::shared_ptr<const Sensor> Projection::sensor_of(RobotIndex robot, std::uint32_t id) const {
    const auto* known = robot < robots().size() ? robots()[robot].find_sensor(id) : nullptr;
    return known == nullptr ? nullptr : known->sensor;
}

bool Projection::is_outdated_by(const LogEntry& entry) const noexcept {
    const bool is_exclusion =
        std::holds_alternative<ScansExcluded>(entry) || std::holds_alternative<ExclusionLifted>(entry);
    return is_exclusion && exclusions()->revision() <= revision();
}

Result<> Projection::apply(const LogEntry& entry) {
    double unbounded = HUGE_VAL;
    if (auto applied = apply(entry, unbounded); !applied) return applied.error();
    return {};
}

Result<bool> Projection::apply(const LogEntry& entry, double& work) {
    // Check that the entry can follow the earlier ones
    if (auto follows = rules_.check(entry); !follows) return follows.error();
    if (is_outdated_by(entry)) {
        return Error{Errc::kConflict,
                     fmt::format("log entry {} changes which of the earlier scans are integrated; replay "
                                 "the log from its beginning with its exclusions",
                                 revision() + 1)};
    }
    // Integrate it into the maps
    const bool is_in = std::visit([&](const auto& body) { return integrate_entry(body, work); }, entry);
    // Count it when it is completely integrated: revision() is its number then
    if (is_in) rules_.apply(entry);
    return is_in;
}

// Each integrate_entry() requires an entry that rules_ accepts and returns whether it is completely applied.

bool Projection::integrate_entry(const RobotJoined& joined, double&) {
    if (joined.robot == robots_.size()) robots_.emplace_back();
    return true;
}

bool Projection::integrate_entry(const SensorDescribed& described, double&) {
    robots_[described.robot].fans.erase(described.sensor.id);
    return true;
}

bool Projection::integrate_entry(const ScanTaken& taken, double& work) {
    const Revision revision = this->revision() + 1;
    const Scan& scan = taken.scan;
    Robot& robot = robots_[taken.robot];

    // Decide whether the maps contain the scan: exclusions and max_jump may leave it out
    const ScanUse use = filter_.use_of(revision, scan_pose_of(taken));
    if (use == ScanUse::kIntegrated) {
        // Place the beams of the sensor in the map
        const Sensor& sensor = *robots()[taken.robot].find_sensor(scan.sensor)->sensor;
        const Pose2 T_map_sensor = compose(*scan.pose, sensor.mount);
        const std::optional<Scan> still = deskewed(robot, sensor, taken);
        const auto& ranges = still ? still->ranges : scan.ranges;
        const auto& fan = fan_of(robot, sensor, still ? *still : scan).fan;
        const ReadingRules readings = rules_of(config_, sensor);
        // Update the cells that they cross; a large scan continues in the next call
        const bool complete =
            sensor.kind == SensorKind::kLaser
                ? laser_.integrate({std::get<LaserFan>(fan), ranges, T_map_sensor, readings}, revision, work)
                : sonar_.integrate({std::get<SonarFan>(fan), ranges, T_map_sensor, readings}, revision, work);
        is_applying_ = !complete;
        if (!complete) return false;
    }
    // Record the scan: the pose for max_jump, the counts, the trajectory
    filter_.take(revision, scan_pose_of(taken));
    if (robots()[taken.robot].poses != Poses::kMap) robot.poses.append(scan.pose);
    if (use == ScanUse::kExcluded) ++robot.excluded;
    if (use == ScanUse::kUnplaced) ++robot.unplaced;
    if (!is_in_trajectory(use)) return true;
    robot.scan_count += 1;
    robot.newest = {revision, scan.stamp, *scan.pose};
    const bool is_estimated = robots()[taken.robot].poses != Poses::kMap;
    if (is_estimated && scan.duration != 0.0) robot.turns[scan.sensor] = *robot.newest;
    robot.trajectory.append(*robot.newest);
    return true;
}

/// Returns the scan without the skew of the robot's motion since the scan before, if the server estimated where both
/// were taken. Poses that a robot sends are used as they are, and so are its scans.
std::optional<Scan> Projection::deskewed(const Robot& robot, const Sensor& sensor, const ScanTaken& taken) const {
    const Scan& scan = taken.scan;
    const auto before = robot.turns.find(scan.sensor);
    if (robots()[taken.robot].poses == Poses::kMap || before == robot.turns.end()) return std::nullopt;
    const auto& [revision, stamp, pose] = before->second;
    const scan_matching::Motion motion{compose(inverse(pose), *scan.pose), scan.stamp - stamp};
    if (!scan_matching::can_deskew(scan, sensor, motion)) return std::nullopt;
    return scan_matching::deskewed(scan, sensor, motion);
}

bool Projection::integrate_entry(const MapPatch& patch, double& work) {
    work -= reach_of(config_, patch).work;
    laser_.import(patch, revision() + 1);
    return true;
}

/// Does nothing: the excluded scans were left out when they were reached.
bool Projection::integrate_entry(const ScansExcluded&, double&) { return true; }

bool Projection::integrate_entry(const ExclusionLifted&, double&) { return true; }

/// Does nothing: who makes the maps with corrected poses calls replace_with().
bool Projection::integrate_entry(const MapsCorrected&, double&) { return true; }

/// Does nothing: it changes how poses are estimated.
bool Projection::integrate_entry(const RobotRelocalized&, double&) { return true; }

/// Does nothing: the scans say in which mode they were taken.
bool Projection::integrate_entry(const ModeChanged&, double&) { return true; }

void Projection::replace_with(Projection corrected) {
    assert(!is_applying_ && !corrected.is_applying_ && revision() == corrected.revision());
    laser_.replace_with(std::move(corrected.laser_), revision());
    sonar_.replace_with(std::move(corrected.sonar_), revision());
    robots_ = std::move(corrected.robots_);
    filter_ = std::move(corrected.filter_);
    corrected_ = revision();
}

const Projection::KnownFan& Projection::fan_of(Robot& robot, const Sensor& sensor, const Scan& scan) {
    auto& known = robot.fans[sensor.id];
    if (is_applying_) return known;
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
    for (const auto& robot : robots_) blocks += robot.trajectory.block_count() + robot.poses.block_count();
    return chunk_count() + blocks;
}

Snapshot Projection::snapshot() {
    Snapshot snapshot{.revision = revision(),
                      .config = config_,
                      .exclusions = filter_.exclusions(),
                      .bounds = bounds(),
                      .is_localize_only = is_localize_only(),
                      .chunk_count = chunk_count(),
                      .laser = laser_.snapshot(),
                      .sonar = sonar_.snapshot()};
    bring_classes_up_to(snapshot.laser);
    snapshot.classes = classes_.snapshot();
    std::vector<EstimatedPosesView> poses;
    snapshot.robots.reserve(robots_.size());
    for (RobotIndex index = 0; index < robots_.size(); ++index) {
        const LoggedRobot& logged = robots()[index];
        const Robot& robot = robots_[index];
        auto& state = snapshot.robots.emplace_back();
        state.name = logged.name;
        state.body_radius = logged.body_radius;
        state.poses = logged.poses;
        state.last_seq = logged.last_seq;
        state.scan_count = robot.scan_count;
        state.excluded = robot.excluded;
        state.unplaced = robot.unplaced;
        state.jumps = filter_.jumps().state(index).left_out;
        state.trajectory = robot.trajectory.snapshot();
        poses.push_back(robot.poses.snapshot());
        if (!robot.newest) continue;
        state.stamp = robot.newest->stamp;
        state.pose = robot.newest->pose;
    }
    const Revision exclusions = has_estimated_poses() ? filter_.exclusions()->revision() : 0;
    snapshot.scan_poses = ScanPoses(std::move(poses), corrected_, exclusions);
    return snapshot;
}

/// Cost: the chunks that changed since the last call, and their neighbours.
void Projection::bring_classes_up_to(const LaserView& laser) {
    std::vector<grid::ChunkKey> changed;
    const Revision newest =
        std::max(revision(), laser.newest({})); // chunks of a checkpoint may be newer than its state
    laser.visit({}, classes_at_, [&](grid::ChunkKey key, const LaserChunk&) { changed.push_back(key); });
    const auto types_of = [&](grid::ChunkKey key) {
        const LaserChunk* chunk = laser.find(key);
        return chunk == nullptr ? nullptr : &chunk->occ_types;
    };
    classes_.update(changed, types_of, newest);
    classes_at_ = revision();
}

Projection Projection::branch() {
    assert(!is_applying_);
    Projection other(config_, filter_.exclusions(), laser_.branch(), sonar_.branch(), classes_.branch());
    other.rules_ = rules_;
    other.classes_at_ = classes_at_;
    other.robots_.reserve(robots_.size());
    for (const auto& robot : robots_) other.robots_.push_back(robot.branch());
    other.filter_ = filter_;
    other.corrected_ = corrected_;
    return other;
}

/// Leaves out the fans, which are recomputed when needed.
Projection::Robot Projection::Robot::branch() const {
    return {scan_count, excluded, unplaced, newest, trajectory.branch(), poses.branch(), turns, {}};
}

ProjectionState Projection::state() const {
    ProjectionState state{revision(),           bounds(),           chunk_count(),  {},
                          filter_.exclusions(), is_localize_only(), frame_origin(), corrected_};
    for (RobotIndex index = 0; index < robots_.size(); ++index) {
        const Robot& robot = robots_[index];
        state.robots.push_back({robots()[index], robot.scan_count, robot.newest, filter_.jumps().state(index),
                                robot.excluded, robot.unplaced, robot.poses.snapshot(), robot.turns});
        state.pages += robot.poses.block_count() + (robot.newest ? 1 : 0); // what restore() keeps
    }
    return state;
}

void Projection::restore(const ProjectionState& state) {
    rules_ = LogRules(state.revision, {state.robots.begin(), state.robots.end()},
                      state.exclusions->as_of(state.revision), state.is_localize_only, state.frame_origin);
    filter_ = ScanFilter(config_.max_jump, state.exclusions);
    corrected_ = state.corrected;
    laser_.restore(state.bounds.laser);
    sonar_.restore(state.bounds.sonar);
    for (const auto& saved : state.robots) {
        auto& robot = robots_.emplace_back();
        robot.scan_count = saved.scan_count;
        robot.excluded = saved.excluded;
        robot.unplaced = saved.unplaced;
        for (std::size_t n = 0; n < saved.scan_poses.size(); ++n) robot.poses.append(saved.scan_poses[n]);
        robot.turns = saved.turns;
        robot.newest = saved.newest;
        const bool has_point = saved.newest && saved.scan_count > 0; // the newest point; earlier ones are in the log
        robot.trajectory = Trajectory(saved.scan_count - (has_point ? 1 : 0));
        if (has_point) robot.trajectory.append(*saved.newest);
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
