#include "sim/noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::sim {

double Random::uniform(double low, double high) {
    const double unit =
        static_cast<double>(engine_() >> 11) * 0x1p-53; // 53 bits: every double of that spacing in [0, 1)
    return low + (high - low) * unit;
}

// Box, Muller (1958), only one of the two values: so the engine holds the whole state.
double Random::gaussian(double sigma) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
    return sigma * radius * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
}

std::size_t Random::index(std::size_t count) {
    return std::min(static_cast<std::size_t>(uniform(0.0, static_cast<double>(count))), count - 1);
}

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

} // namespace scanloom::sim
