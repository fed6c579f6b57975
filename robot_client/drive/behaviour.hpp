#pragma once

#include <limits>
#include <numbers>

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

/// Decides where to drive, one control step after the other. The same inputs give the same drive.
class Behaviour {
public:
    virtual ~Behaviour() = default;

    /// The velocity until the next step, from the newest scan.
    [[nodiscard]] virtual Velocity step(const SectorRanges& nearest) = 0;
};

} // namespace scanloom::robot
