#include "robot_client/sim/noise.hpp"

#include <algorithm>

namespace scanloom::robot {

Noise with_odometry(Noise noise, double scale) {
    noise.odometry_forward *= scale;
    noise.odometry_turn *= scale;
    noise.odometry_drift *= scale;
    return noise;
}

RangeMm reading(double range, const Sensor& sensor, const std::optional<Noise>& noise, Random& random) {
    if (range >= sensor.range_max) return kNoReturn;
    if (noise) range += random.gaussian(noise->range);
    if (noise && noise->range_uniform > 0.0) range += random.uniform(0.0, noise->range_uniform);
    // A return stays a return: at least one millimetre inside the limits.
    return to_range_mm(std::clamp(range, sensor.range_min + 0.001, sensor.range_max - 0.001));
}

double true_direction(double yaw_rad, const std::optional<Noise>& noise, Random& random) {
    return noise ? yaw_rad + random.gaussian(noise->beam_angle) : yaw_rad;
}

} // namespace scanloom::robot
