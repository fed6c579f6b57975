#pragma once

#include "common/scan/poses.hpp"
#include "sim/drive/behaviour.hpp"
#include "sim/noise.hpp"
#include "sim/range_sensors.hpp"
#include "sim/world.hpp"

#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

namespace scanloom::sim {

inline constexpr int kControlStepsPerScan = 2;                               ///< 20 Hz control, 10 Hz sensors
inline constexpr double kScanPeriod = kControlStepsPerScan * kControlPeriod; ///< seconds

/// The motion of a body in one step, as odometry measures it: along its heading and around itself.
struct Motion {
    double forward = 0.0; ///< metres along the arc
    double turn = 0.0;    ///< radians

    friend bool operator==(const Motion&, const Motion&) = default;
};

/// Integrates x' = v cos yaw, y' = v sin yaw, yaw' = w exactly for constant v and w.
[[nodiscard]] Pose2 moved(const Pose2& pose, const Motion& motion);

/// The speed of a person who walks with a lidar in the hand.
inline constexpr Velocity kWalkMax{1.0, std::numbers::pi / 2.0};

/// Returns the robot's motion in one control period, with the velocity limited to what it can do. A body that would
/// touch a solid or a walker does not advance; it may still turn, because it is round.
/// @param fastest  the limits. Pre: in one period the body moves less than its radius
[[nodiscard]] Motion drive(const World& world, const Pose2& pose, const Velocity& wanted,
                           const Velocity& fastest = {kForwardMax, kTurnMax});

/// The pose by which a robot steers, and which it sends with its scans if its poses are Poses::kMap.
enum class PoseSent {
    kTrue,     ///< the true pose
    kOdometry, ///< the odometry from the true start on, which drifts
};

struct SimulatorOptions {
    World world;
    std::optional<Sensor> laser; ///< none: the robot has sonars
    std::optional<Noise> noise;  ///< none: all measurements are exact
    std::uint64_t seed = 1;
    std::optional<Pose2> start;  ///< none: a free place chosen by the seed
    std::optional<Sensor> sonar; ///< a further sensor with its own id
    PoseSent pose = PoseSent::kTrue;
    Poses poses = Poses::kMap; ///< what it sends with its scans
    /// A person carries the laser: walks up to kWalkMax, in proportion to the speed that the behaviour wants, and the
    /// beams are taken one after another while it moves.
    bool is_carried = false;
};

/// A robot that drives through a world and scans it. The options determine everything: there is no clock and no other
/// randomness. People in the world keep walking while it drives.
///
/// SimulatorOptions::pose is Senses::pose and, with Poses::kMap, scan.pose: the map frame is that of the scans.
/// scan.odometry then starts at (0, 0, 0). With Poses::kOdometry, scan.pose is absent and scan.odometry starts at the
/// true start, so that the frame of the odometry is that of the world at first; correct() says where it is since then.
/// With Poses::kNone both are absent. The robot steers by its laser. Without a laser it steers by its sonars and places
/// each echo on the cone's axis; sonars whose cone includes directions behind the robot do not count in
/// Senses::nearest.
///
/// With SimulatorOptions::is_carried, the beams of a scan are taken during the control step before its stamp and the
/// one after it, counter-clockwise at an even speed (Scan::duration); its pose is that at the stamp. The first scan is
/// taken at rest.
class Simulator {
public:
    /// Pre: the options contain a sensor; a carried laser is the only one.
    Simulator(SimulatorOptions options, std::unique_ptr<Behaviour> behaviour);

    /// Returns the next scan. Each sensor scans ten times per second, all at the same time; the laser's scan comes
    /// first. The first scans are taken where the robot starts, at 0 s.
    [[nodiscard]] Scan next_scan();

    /// Lets the robot steer by T_map_odom times its odometry. For PoseSent::kOdometry with Poses::kOdometry.
    /// @param T_map_odom  the frame of the odometry that is sent, in the frame of the robot's paths; at first the identity
    void correct(const Pose2& T_map_odom);

    /// Returns the sensors, in the order of their scans.
    [[nodiscard]] const std::vector<std::shared_ptr<const Sensor>>& sensors() const noexcept { return sensors_; }
    /// Returns the sensor that took a scan. Pre: it is one of this simulator's.
    [[nodiscard]] const std::shared_ptr<const Sensor>& sensor_of(const Scan& scan) const;

    /// Returns the current world, in which people have moved.
    [[nodiscard]] const World& world() const noexcept { return options_.world; }
    /// Returns the robot's true pose after the last control step.
    [[nodiscard]] const Pose2& pose() const noexcept { return pose_; }
    [[nodiscard]] const Behaviour& behaviour() const noexcept { return *behaviour_; }
    /// Returns the number of control steps in which a solid or a person blocked the robot.
    [[nodiscard]] std::uint64_t collisions() const noexcept { return collisions_; }

private:
    Motion control_step();
    void turn_in_time(const Sensor& laser, bool is_moving, Scan& scan);
    void set_poses(Scan& scan) const;
    [[nodiscard]] Motion as_the_wheels_tell(const Motion& motion);
    [[nodiscard]] Pose2 believed_pose() const;

    SimulatorOptions options_;
    std::unique_ptr<Behaviour> behaviour_;
    Random random_;
    std::vector<std::shared_ptr<const Sensor>> sensors_;
    Pose2 start_;
    Pose2 pose_;
    Pose2 odometry_;
    Pose2 T_map_odom_; // see correct()
    Senses senses_;
    std::uint64_t scans_ = 0;
    std::uint64_t collisions_ = 0;
};

} // namespace scanloom::sim
