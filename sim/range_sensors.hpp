#pragma once

#include "common/error/error.hpp"
#include "sim/noise.hpp"
#include "sim/world.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace scanloom::sim {

/// Returns a laser by name. "reference": 684 beams over -90..+90 degrees, 5 m. "lidar360": 360 beams all round, 12 m.
/// "wide": 1081 beams over 270 degrees, 30 m. "handheld": 450 beams all round, 12 m, for a lidar that a person carries.
/// All are mounted on the robot's centre and turn ten times per second.
/// Errors: kNotFound if there is no laser of that name; the message lists all names.
[[nodiscard]] Result<Sensor> find_laser(std::string_view name);

/// Simulates one scan of a laser, including walkers. Without noise the readings are exact except for rounding to
/// millimetres. Beams that hit nothing within range_max are kNoReturn; noise neither adds nor removes returns.
[[nodiscard]] std::vector<RangeMm> sweep(const World& world, const Sensor& laser, const Pose2& T_map_laser,
                                         const std::optional<Noise>& noise, Random& random);

/// Simulates some beams of a laser that moves while it turns.
/// @param first        index of the first of these beams
/// @param T_map_laser  one pose per beam
/// @return their readings, as sweep()
/// Pre: the laser has the beams.
[[nodiscard]] std::vector<RangeMm> sweep_beams(const World& world, const Sensor& laser, std::size_t first,
                                               std::span<const Pose2> T_map_laser, const std::optional<Noise>& noise,
                                               Random& random);

/// Returns a ring of sonars by name. "ring16": 16 sonars evenly around the body, counter-clockwise, the first pointing
/// backwards and the ninth ahead; cones of 30 degrees, 5 m. They form one sensor on the robot's centre, because the
/// beams of one sensor start at one place. So cones and ranges start at the centre, not at the rim, and the smallest
/// range is the rim's, 0.15 m.
/// Errors: kNotFound if there are no sonars of that name; the message lists all names.
[[nodiscard]] Result<Sensor> find_sonar(std::string_view name);

/// Simulates one scan of sonars: for each the nearest return within its whole cone, including walkers. Without noise
/// the readings are exact except for rounding to millimetres; noise rotates cones as it rotates the beams of lasers.
/// Pre: 0 < sonar.aperture < pi.
[[nodiscard]] std::vector<RangeMm> listen(const World& world, const Sensor& sonar, const Pose2& T_map_sonar,
                                          const std::optional<Noise>& noise, Random& random);

} // namespace scanloom::sim
