#pragma once

#include "common/error/error.hpp"
#include "robot_client/sim/noise.hpp"
#include "robot_client/sim/world.hpp"

#include <string_view>
#include <vector>

namespace scanloom::robot {

/// "ring16": 16 sonars evenly around the body, the first one behind and the ninth ahead, counter-clockwise; cones of 30
/// degrees, 5 m. One sensor on the robot's centre, as the beams of one sensor begin at one place: cones widen from the
/// centre, not from the rim, and ranges count from there, so that 0.15 m, the rim, is the least.
/// Errors  kNotFound: no sonars of that name; the message lists those there are.
[[nodiscard]] Result<Sensor> find_sonar(std::string_view name);

/// What each sonar of a sensor hears from a place: the nearest return within its whole cone, walkers included. Without
/// noise exact but for the rounding to millimetres; noise turns cones as it turns beams of lasers.
/// Pre  0 < sonar.aperture < pi.
[[nodiscard]] std::vector<RangeMm> listen(const World& world, const Sensor& sonar, const Pose2& T_map_sonar,
                                          const std::optional<Noise>& noise, Random& random);

} // namespace scanloom::robot
