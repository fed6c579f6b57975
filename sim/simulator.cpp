#include "sim/simulator.hpp"

#include "sim/drive/nearby_obstacles.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace scanloom::sim {

Pose2 moved(const Pose2& pose, const Motion& motion) {
    // The chord of an arc: as long as the arc if it is straight, and turned by half of its angle.
    const double half = motion.turn / 2.0;
    const double chord = std::abs(half) < 1e-9 ? motion.forward : motion.forward * std::sin(half) / half;
    return {pose.x + chord * std::cos(pose.yaw + half), pose.y + chord * std::sin(pose.yaw + half),
            normalize_angle(pose.yaw + motion.turn)};
}

Motion drive(const World& world, const Pose2& pose, const Velocity& wanted, const Velocity& fastest) {
    Motion motion{std::clamp(wanted.forward, -fastest.forward, fastest.forward) * kControlPeriod,
                  std::clamp(wanted.turn, -fastest.turn, fastest.turn) * kControlPeriod};
    // A step is less than the body's radius, so nothing can pass between two checks.
    const Pose2 next = moved(pose, motion);
    if (clearance(world, {next.x, next.y}) < kBodyRadius) motion.forward = 0.0;
    return motion;
}

namespace {

Pose2 choose_start(const World& world, Random& random) {
    for (;;) { // ends because a free place exists
        const Box& floor = world.starts[random.index(world.starts.size())];
        const Point2 place{random.uniform(floor.x_min, floor.x_max), random.uniform(floor.y_min, floor.y_max)};
        if (clearance(world, place) < world.start_clearance) continue;
        return {place.x, place.y, random.uniform(-std::numbers::pi, std::numbers::pi)};
    }
}

std::vector<RangeMm> measure(const World& world, const Sensor& sensor, const Pose2& robot,
                             const std::optional<Noise>& noise, Random& random) {
    const Pose2 T_map_sensor = compose(robot, sensor.mount);
    return sensor.kind == SensorKind::kLaser ? sweep(world, sensor, T_map_sensor, noise, random)
                                             : listen(world, sensor, T_map_sensor, noise, random);
}

/// Returns the sectors of a scan. Of sonars, only those whose whole cone points ahead count: echoes of the others may
/// come from behind the robot and are no reason to back off.
SectorRanges sectors_of(Scan scan, const Sensor& sensor) {
    constexpr double kAhead = std::numbers::pi / 2.0 + 1e-9;
    for (std::size_t i = 0; sensor.kind == SensorKind::kSonar && i < scan.ranges.size(); ++i) {
        const double axis = normalize_angle(beam_angle(sensor.angles, i));
        if (std::abs(axis) + sensor.aperture / 2.0 > kAhead) scan.ranges[i] = kInvalidRange;
    }
    return sector_ranges(scan, sensor);
}

} // namespace

Simulator::Simulator(SimulatorOptions options, std::unique_ptr<Behaviour> behaviour)
    : options_(std::move(options)), behaviour_(std::move(behaviour)), random_(options_.seed),
      start_(options_.start ? *options_.start : choose_start(options_.world, random_)), pose_(start_) {
    for (const auto& sensor : {options_.laser, options_.sonar}) {
        if (sensor) sensors_.push_back(std::make_shared<const Sensor>(*sensor));
    }
    assert(!sensors_.empty());
    assert(!options_.is_carried || (options_.laser && !options_.sonar));
}

Scan Simulator::next_scan() {
    const std::uint64_t moment = scans_ / sensors_.size();
    const std::size_t which = scans_ % sensors_.size();
    const Sensor& sensor = *sensors_[which];
    Scan scan;
    scan.stamp = static_cast<double>(moment * kControlStepsPerScan) * kControlPeriod;
    scan.sensor = sensor.id;
    if (options_.is_carried) {
        turn_in_time(sensor, moment > 0, scan);
    } else {
        for (int i = 0; moment > 0 && which == 0 && i < kControlStepsPerScan; ++i) control_step();
        set_poses(scan);
        scan.ranges = measure(options_.world, sensor, pose_, options_.noise, random_);
    }
    if (which == 0) {
        senses_.nearest = sectors_of(scan, sensor);
        senses_.obstacles = obstacles_of(scan, sensor);
    }
    if (options_.poses != Poses::kMap) scan.pose.reset();
    ++scans_;
    return scan;
}

/// Sets the pose, by which the robot steers whatever it sends, and the odometry.
void Simulator::set_poses(Scan& scan) const {
    scan.pose = believed_pose();
    if (options_.poses == Poses::kMap) scan.odometry = odometry_;
    if (options_.poses == Poses::kOdometry) scan.odometry = compose(start_, odometry_);
}

/// Takes the beams of one turn while the laser moves: half of them in each of two control steps.
void Simulator::turn_in_time(const Sensor& laser, bool is_moving, Scan& scan) {
    static_assert(kControlStepsPerScan == 2, "the stamp is between the two steps");
    const std::size_t count = beam_count(laser.angles);
    scan.duration = kScanPeriod * static_cast<double>(count - 1) / static_cast<double>(count);
    for (std::size_t step = 0; step < kControlStepsPerScan; ++step) {
        if (step == 1) set_poses(scan);
        const Pose2 begin = pose_;
        const Motion motion = is_moving ? control_step() : Motion{};
        std::vector<Pose2> poses;
        const std::size_t first = step * count / kControlStepsPerScan;
        for (std::size_t beam = first; beam < (step + 1) * count / kControlStepsPerScan; ++beam) {
            const double part = (static_cast<double>(beam) + 0.5) * kControlStepsPerScan / static_cast<double>(count) -
                                static_cast<double>(step);
            poses.push_back(compose(moved(begin, {part * motion.forward, part * motion.turn}), laser.mount));
        }
        const auto ranges = sweep_beams(options_.world, laser, first, poses, options_.noise, random_);
        scan.ranges.insert(scan.ranges.end(), ranges.begin(), ranges.end());
    }
}

void Simulator::correct(const Pose2& T_map_odom) {
    const Pose2 moved = compose(T_map_odom, inverse(T_map_odom_));
    for (Point2& obstacle : senses_.obstacles) obstacle = transform(moved, obstacle);
    T_map_odom_ = T_map_odom;
}

const std::shared_ptr<const Sensor>& Simulator::sensor_of(const Scan& scan) const {
    return *std::ranges::find_if(sensors_, [&](const auto& sensor) { return sensor->id == scan.sensor; });
}

Motion Simulator::control_step() {
    senses_.pose = believed_pose();
    Velocity wanted = behaviour_->step(senses_);
    if (options_.is_carried) wanted.forward *= kWalkMax.forward / kForwardMax;
    const Motion motion =
        options_.is_carried ? drive(options_.world, pose_, wanted, kWalkMax) : drive(options_.world, pose_, wanted);
    if (motion.forward == 0.0 && wanted.forward != 0.0) ++collisions_;
    pose_ = moved(pose_, motion);
    odometry_ = moved(odometry_, as_the_wheels_tell(motion));
    walk(options_.world, {pose_.x, pose_.y}, kControlPeriod);
    return motion;
}

Pose2 Simulator::believed_pose() const {
    return options_.pose == PoseSent::kTrue ? pose_ : compose(T_map_odom_, compose(start_, odometry_));
}

Motion Simulator::as_the_wheels_tell(const Motion& motion) {
    if (!options_.noise) return motion;
    const Noise& noise = *options_.noise;
    return {motion.forward + random_.gaussian(noise.odometry_forward * std::abs(motion.forward)),
            motion.turn + random_.gaussian(noise.odometry_turn * std::abs(motion.turn) +
                                           noise.odometry_drift * std::abs(motion.forward))};
}

} // namespace scanloom::sim
