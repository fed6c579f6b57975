#pragma once

#include "robot_client/drive/behaviour.hpp"
#include "robot_client/sim/laser.hpp"
#include "robot_client/sim/random.hpp"
#include "robot_client/sim/sonar.hpp"
#include "robot_client/sim/unicycle.hpp"
#include "robot_client/sim/world.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace scanloom::robot {

inline constexpr int kControlStepsPerScan = 2;                               ///< 20 Hz control, 10 Hz sensors
inline constexpr double kScanPeriod = kControlStepsPerScan * kControlPeriod; ///< seconds

/// Which pose a robot sends with its scans.
enum class PoseSent {
    kTrue,     ///< where it is
    kOdometry, ///< where its wheels believe it is, told where it started: it drifts off
};

struct SimulatorOptions {
    World world;
    std::optional<Sensor> laser; ///< absent: it has sonars
    std::optional<Noise> noise;  ///< absent: everything is exact
    std::uint64_t seed = 1;
    std::optional<Pose2> start;  ///< absent: a free place that the seed chooses
    std::optional<Sensor> sonar; ///< another sensor, with an id of its own
    PoseSent pose = PoseSent::kTrue;
};

/// A robot that drives through a world and scans it. Everything follows from the options: no clock, no other
/// randomness. People in the world walk on while it drives.
///
/// scan.pose is what the options say, and so is Senses::pose: the map frame is that of the scans. scan.odometry is what
/// its wheels believe, from (0, 0, 0) on. It steers by its laser; without one, by its sonars, whose echoes it takes to
/// come from their axes, and of which those that hear what is behind it have no say in Senses::nearest.
class Simulator {
public:
    /// Pre  the options hold a sensor.
    Simulator(SimulatorOptions options, std::unique_ptr<Behaviour> behaviour);

    /// The next scan. Each sensor takes one ten times a second, all at the same moment, the laser's first; the first
    /// ones are taken where the robot starts, at 0 s.
    [[nodiscard]] Scan next_scan();

    /// The sensors, in the order of their scans.
    [[nodiscard]] const std::vector<std::shared_ptr<const Sensor>>& sensors() const noexcept { return sensors_; }
    /// The sensor that took a scan. Pre  it is one of this simulator's.
    [[nodiscard]] const std::shared_ptr<const Sensor>& sensor_of(const Scan& scan) const;

    /// The world as it is now: people have moved.
    [[nodiscard]] const World& world() const noexcept { return options_.world; }
    /// Where the robot really is.
    [[nodiscard]] const Pose2& pose() const noexcept { return pose_; }
    [[nodiscard]] const Behaviour& behaviour() const noexcept { return *behaviour_; }
    /// Control steps in which a solid or a person kept the robot from advancing.
    [[nodiscard]] std::uint64_t collisions() const noexcept { return collisions_; }

private:
    void control_step();
    [[nodiscard]] Motion as_the_wheels_tell(const Motion& motion);
    [[nodiscard]] Pose2 pose_sent() const;

    SimulatorOptions options_;
    std::unique_ptr<Behaviour> behaviour_;
    Random random_;
    std::vector<std::shared_ptr<const Sensor>> sensors_;
    Pose2 start_;
    Pose2 pose_;
    Pose2 odometry_;
    Senses senses_;
    std::uint64_t scans_ = 0;
    std::uint64_t collisions_ = 0;
};

} // namespace scanloom::robot
