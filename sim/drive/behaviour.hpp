#pragma once

#include "common/geometry/pose2.hpp"

#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace scanloom::sim {

/// The reference robot's body: a disc with a differential drive. (Wheelbase 0.230 m, wheel radius 0.035 m; the unicycle
/// model needs neither.)
inline constexpr double kBodyRadius = 0.15;          ///< metres
inline constexpr double kForwardMax = 0.70;          ///< metres per second
inline constexpr double kTurnMax = std::numbers::pi; ///< radians per second
inline constexpr double kControlPeriod = 0.05;       ///< seconds: 20 Hz

/// Commanded velocity: metres per second forward, radians per second counter-clockwise.
struct Velocity {
    double forward = 0.0;
    double turn = 0.0;

    friend bool operator==(const Velocity&, const Velocity&) = default;
};

/// The nearest reading of a scan in each of three sectors, in metres; infinite if there is none.
struct SectorRanges {
    double right = std::numeric_limits<double>::infinity(); ///< beams from -90 to -30 degrees
    double front = std::numeric_limits<double>::infinity(); ///< beams from -30 to 30 degrees
    double left = std::numeric_limits<double>::infinity();  ///< beams from 30 to 90 degrees
};

/// Inputs of a control step. The scan may be one control step old, the pose is current.
struct Senses {
    Pose2 pose;                    ///< T_map_robot, current
    SectorRanges nearest;          ///< of the newest laser scan
    std::vector<Point2> obstacles; ///< end points of its returns, metres in the map frame
};

/// Decides the robot's velocity in each control step. The same inputs give the same drive.
class Behaviour {
public:
    virtual ~Behaviour() = default;

    /// Returns the velocity until the next step.
    [[nodiscard]] virtual Velocity step(const Senses& senses) = 0;

    /// Returns whether the behaviour has finished; from then on the robot stands still.
    [[nodiscard]] virtual bool is_done() const { return false; }

    /// Returns whether the behaviour finishes by itself at some time.
    [[nodiscard]] virtual bool has_an_end() const { return false; }

    /// Returns one sentence for people about the drive so far; may be empty.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

} // namespace scanloom::sim
