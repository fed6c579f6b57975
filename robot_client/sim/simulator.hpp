#pragma once

#include "robot_client/drive/behaviour.hpp"
#include "robot_client/sim/laser.hpp"
#include "robot_client/sim/random.hpp"
#include "robot_client/sim/unicycle.hpp"
#include "robot_client/sim/world.hpp"

#include <cstdint>
#include <memory>

namespace scanloom::robot {

inline constexpr int kControlStepsPerScan = 2;                               ///< 20 Hz control, 10 Hz laser
inline constexpr double kScanPeriod = kControlStepsPerScan * kControlPeriod; ///< seconds

struct SimulatorOptions {
    World world;
    Sensor laser;
    std::optional<Noise> noise; ///< absent: everything is exact
    std::uint64_t seed = 1;
    std::optional<Pose2> start; ///< absent: a free place that the seed chooses
};

/// A robot that drives through a world and scans it. Everything follows from the options: no clock, no other
/// randomness. People in the world walk on while it drives. scan.pose is the true pose in the world; scan.odometry
/// is what its wheels believe, from (0, 0, 0) on.
class Simulator {
public:
    Simulator(SimulatorOptions options, std::unique_ptr<Behaviour> behaviour);

    /// The next scan, a tenth of a second after the one before; the first is taken where the robot starts, at 0 s.
    [[nodiscard]] Scan next_scan();

    /// The world as it is now: people have moved.
    [[nodiscard]] const World& world() const noexcept { return options_.world; }
    [[nodiscard]] const Pose2& pose() const noexcept { return pose_; }
    [[nodiscard]] const Sensor& laser() const noexcept { return options_.laser; }
    [[nodiscard]] const Behaviour& behaviour() const noexcept { return *behaviour_; }
    /// Control steps in which a solid or a person kept the robot from advancing.
    [[nodiscard]] std::uint64_t collisions() const noexcept { return collisions_; }

private:
    void control_step();
    [[nodiscard]] Motion as_the_wheels_tell(const Motion& motion);

    SimulatorOptions options_;
    std::unique_ptr<Behaviour> behaviour_;
    Random random_;
    Pose2 pose_;
    Pose2 odometry_;
    Senses senses_;
    std::uint64_t scans_ = 0;
    std::uint64_t collisions_ = 0;
};

} // namespace scanloom::robot
