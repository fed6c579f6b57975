#pragma once

#include "common/error/error.hpp"
#include "robot_client/sim/noise.hpp"
#include "robot_client/sim/world.hpp"

#include <string_view>
#include <vector>

namespace scanloom::robot {

/// Returns a laser by name. "reference": 684 beams over -90..+90 degrees, 5 m. "lidar360": 360 beams all round, 12 m.
/// "wide": 1081 beams over 270 degrees, 30 m. All are mounted on the robot's centre and turn ten times per second.
/// Errors: kNotFound if there is no laser of that name; the message lists all names.
[[nodiscard]] Result<Sensor> find_laser(std::string_view name);

/// Simulates one scan of a laser, including walkers. Without noise the readings are exact except for rounding to
/// millimetres. Beams that hit nothing within range_max are kNoReturn; noise neither adds nor removes returns.
[[nodiscard]] std::vector<RangeMm> sweep(const World& world, const Sensor& laser, const Pose2& T_map_laser,
                                         const std::optional<Noise>& noise, Random& random);

} // namespace scanloom::robot
