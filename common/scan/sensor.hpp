#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/beam_angles.hpp"

#include <cstdint>
#include <string>

namespace scanloom {

/// What a sensor measures with: narrow beams of light, or wide cones of sound.
enum class SensorKind { kLaser, kSonar };

/// A range sensor of a robot. Metres and radians, counter-clockwise.
///
/// A reading z is invalid if z < range_min or z is zero or NaN: the beam shows nothing. It is a hit at z if
/// range_min <= z < range_max. If z >= range_max, there is no obstacle within range_max.
///
/// Frames: the origin of the sensor frame is the point from which ranges are measured; the beam at angle 0 points along
///         its x axis.
struct Sensor {
    std::uint32_t id = 0;                 ///< 0 to 63, assigned by the robot
    SensorKind kind = SensorKind::kLaser; ///< decides which layers its scans change
    std::string name;                     ///< for people, up to 64 bytes
    Pose2 mount;            ///< T_robot_sensor: the sensor's pose in the robot frame (x ahead, y to the left)
    BeamAngles angles;      ///< for scans without angles of their own
    double aperture = 0.0;  ///< full width of a beam, radians; 0: the session's default
    double range_min = 0.0; ///< metres
    double range_max = 0.0; ///< above range_min, at most 1000 m

    friend bool operator==(const Sensor&, const Sensor&) = default;
};

} // namespace scanloom
