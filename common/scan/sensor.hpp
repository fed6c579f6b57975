#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/beam_angles.hpp"

#include <cstdint>
#include <string>

namespace scanloom {

enum class SensorKind { kLaser, kSonar };

/// A range sensor of a robot. Metres and radians, counter-clockwise.
///
/// A reading z means: z < range_min, zero or not a number: nothing is learnt from the beam;
/// range_min <= z < range_max: a hit at z; z >= range_max: nothing stands within range_max.
///
/// Frames  sensor: its origin is where ranges are measured from, the beam at angle 0 points along its x axis.
struct Sensor {
    std::uint32_t id = 0; ///< the robot's own number for it, 0 to 63
    SensorKind kind = SensorKind::kLaser;
    std::string name;      ///< for people, up to 64 bytes
    Pose2 mount;           ///< T_robot_sensor: the sensor's pose in the robot frame (x ahead, y to the left)
    BeamAngles angles;     ///< used by scans that carry none: UniformAngles{first, increment, count}, or a list
    double aperture = 0.0; ///< full width of a beam, radians; 0 = the session's default
    double range_min = 0.0;
    double range_max = 0.0; ///< more than range_min, up to 1000 m

    friend bool operator==(const Sensor&, const Sensor&) = default;
};

} // namespace scanloom
