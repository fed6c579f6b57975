#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <optional>
#include <random>

namespace scanloom::sim {

/// Random numbers that are the same on every machine. The C++ standard defines the engine; the distributions are
/// implemented here because those of <random> differ between libraries.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    /// Returns a uniformly distributed number in [low, high).
    [[nodiscard]] double uniform(double low, double high);

    /// Returns a normally distributed number with mean 0.
    [[nodiscard]] double gaussian(double sigma);

    /// Returns a uniformly distributed index in 0 .. count - 1. Pre: count > 0.
    [[nodiscard]] std::size_t index(std::size_t count);

private:
    std::mt19937_64 engine_;
};

/// The noise of a simulated robot's measurements. Standard deviations, except range_uniform.
struct Noise {
    double range = 0.02;            ///< metres, for each return
    double range_uniform = 0.0;     ///< metres; each return is too long by a uniform random length up to this
    double beam_angle = 0.005;      ///< radians, of each beam's true direction
    double odometry_forward = 0.05; ///< metres per metre driven, within one control step
    double odometry_turn = 0.05;    ///< radians per radian turned
    double odometry_drift = 0.02;   ///< radians per metre driven
};

/// Returns the noise with its odometry part multiplied by `scale`. Pre: scale >= 0.
[[nodiscard]] Noise with_odometry(Noise noise, double scale);

/// Returns the reading of a sensor whose beam first hits something at `range` metres: kNoReturn at range_max or beyond.
/// Noise neither adds nor removes returns: beams without a return are handled before, and a noisy return stays within
/// the sensor's limits.
[[nodiscard]] RangeMm reading(double range, const Sensor& sensor, const std::optional<Noise>& noise, Random& random);

/// Returns the true direction of a beam, in radians. Draws a random number only if there is noise.
[[nodiscard]] double true_direction(double yaw_rad, const std::optional<Noise>& noise, Random& random);

} // namespace scanloom::sim
