#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/beam_angles.hpp"

#include <cstdint>
#include <string>

namespace scanloom {

enum class SensorKind { kLaser, kSonar };

/// A range sensor of a robot. Metres and radians.
///
/// A reading z means: z < range_min, zero or not a number: nothing is learnt from the beam;
/// range_min <= z < range_max: a hit at z; z >= range_max: nothing stands within range_max.
struct Sensor {
    std::uint32_t id = 0; ///< the robot's own number for it
    SensorKind kind = SensorKind::kLaser;
    std::string name;      ///< for people
    Pose2 mount;           ///< T_robot_sensor
    BeamAngles angles;     ///< used by scans that carry none
    double aperture = 0.0; ///< full width of a beam, radians; 0 = the session's default
    double range_min = 0.0;
    double range_max = 0.0;

    friend bool operator==(const Sensor&, const Sensor&) = default;
};

} // namespace scanloom
