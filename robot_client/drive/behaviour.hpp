#pragma once

#include "common/geometry/pose2.hpp"

#include <limits>
#include <string>
#include <vector>

namespace scanloom::robot {

/// What a robot's wheels are asked to do: metres a second forward, radians a second counter-clockwise.
struct Velocity {
    double forward = 0.0;
    double turn = 0.0;

    friend bool operator==(const Velocity&, const Velocity&) = default;
};

/// The nearest reading of a scan in each of three sectors, metres; infinite where there is none.
struct SectorRanges {
    double right = std::numeric_limits<double>::infinity(); ///< beams from -90 to -30 degrees
    double front = std::numeric_limits<double>::infinity(); ///< beams from -30 to 30 degrees
    double left = std::numeric_limits<double>::infinity();  ///< beams from 30 to 90 degrees
};

/// What a robot knows when it decides where to drive. The scan may be a control step old; the pose is not.
struct Senses {
    Pose2 pose;                    ///< T_map_robot, now
    SectorRanges nearest;          ///< of the newest laser scan
    std::vector<Point2> obstacles; ///< where its beams ended, metres in the map frame; beams without a return are none
};

/// Decides where to drive, one control step after the other. The same inputs give the same drive.
class Behaviour {
public:
    virtual ~Behaviour() = default;

    /// The velocity until the next step.
    [[nodiscard]] virtual Velocity step(const Senses& senses) = 0;

    /// There is nothing left for it to do; from then on it stands still.
    [[nodiscard]] virtual bool is_done() const { return false; }

    /// Whether it comes to an end by itself, some time.
    [[nodiscard]] virtual bool has_an_end() const { return false; }

    /// What people should know of how it went so far, a sentence; empty: nothing.
    [[nodiscard]] virtual std::string remarks() const { return {}; }
};

} // namespace scanloom::robot
