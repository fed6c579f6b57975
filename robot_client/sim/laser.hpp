#pragma once

#include "common/error/error.hpp"
#include "robot_client/sim/noise.hpp"
#include "robot_client/sim/world.hpp"

#include <string_view>
#include <vector>

namespace scanloom::robot {

/// "reference": 684 beams over -90..+90 degrees, 5 m. "lidar360": 360 beams all round, 12 m.
/// "wide": 1081 beams over 270 degrees, 30 m. All stand on the robot's centre and turn ten times a second.
/// Errors  kNotFound: no laser of that name; the message lists those there are.
[[nodiscard]] Result<Sensor> find_laser(std::string_view name);

/// What the laser measures from a place, walkers included. Without noise the readings are exact but for the rounding to
/// millimetres. Beams that meet nothing within range_max are kNoReturn; noise neither makes nor takes returns.
[[nodiscard]] std::vector<RangeMm> sweep(const World& world, const Sensor& laser, const Pose2& T_map_laser,
                                         const std::optional<Noise>& noise, Random& random);

} // namespace scanloom::robot
