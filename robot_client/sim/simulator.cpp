#include "robot_client/sim/simulator.hpp"

#include "robot_client/drive/sectors.hpp"

#include <cmath>
#include <numbers>

namespace scanloom::robot {
namespace {

constexpr double kStartClearance = 0.5; // metres

Pose2 choose_start(const World& world, Random& random) {
    for (;;) { // there is a free place, so this ends
        const Box& floor = world.starts[random.index(world.starts.size())];
        const Point2 place{random.uniform(floor.x_min, floor.x_max), random.uniform(floor.y_min, floor.y_max)};
        if (clearance(world, place) < kStartClearance) continue;
        return {place.x(), place.y(), random.uniform(-std::numbers::pi, std::numbers::pi)};
    }
}

} // namespace

Simulator::Simulator(SimulatorOptions options, std::unique_ptr<Behaviour> behaviour)
    : options_(std::move(options)), behaviour_(std::move(behaviour)), random_(options_.seed),
      pose_(options_.start ? *options_.start : choose_start(options_.world, random_)) {}

Scan Simulator::next_scan() {
    if (scans_ > 0) {
        for (int i = 0; i < kControlStepsPerScan; ++i) control_step();
    }
    Scan scan;
    scan.stamp = static_cast<double>(scans_ * kControlStepsPerScan) * kControlPeriod;
    scan.sensor = options_.laser.id;
    scan.pose = pose_;
    scan.odometry = odometry_;
    const Pose2 T_map_laser = compose(pose_, options_.laser.mount);
    scan.ranges = sweep(options_.world, options_.laser, T_map_laser, options_.noise, random_);
    senses_.nearest = sector_ranges(scan, options_.laser);
    senses_.obstacles = obstacles_of(scan, options_.laser);
    ++scans_;
    return scan;
}

void Simulator::control_step() {
    senses_.pose = pose_;
    const Velocity wanted = behaviour_->step(senses_);
    const Motion motion = drive(options_.world, pose_, wanted);
    if (motion.forward == 0.0 && wanted.forward != 0.0) ++collisions_;
    pose_ = moved(pose_, motion);
    odometry_ = moved(odometry_, as_the_wheels_tell(motion));
    walk(options_.world, {pose_.x, pose_.y}, kControlPeriod);
}

Motion Simulator::as_the_wheels_tell(const Motion& motion) {
    if (!options_.noise) return motion;
    const Noise& noise = *options_.noise;
    return {motion.forward + random_.gaussian(noise.odometry_forward * std::abs(motion.forward)),
            motion.turn + random_.gaussian(noise.odometry_turn * std::abs(motion.turn) +
                                           noise.odometry_drift * std::abs(motion.forward))};
}

} // namespace scanloom::robot
