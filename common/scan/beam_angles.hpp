#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace scanloom {

/// Beam i points along first + i * increment. Radians in the sensor frame, counter-clockwise.
struct UniformAngles {
    double first = 0.0;
    double increment = 0.0;
    std::uint32_t count = 0;

    friend bool operator==(const UniformAngles&, const UniformAngles&) = default;
};

/// An angle for each beam, radians in the sensor frame, for beams that are not evenly spaced.
using ExplicitAngles = std::vector<double>;

/// Beam i points along unit * steps[i], radians in the sensor frame: what a spinning sensor gives that measures its
/// angles in whole steps. From one beam to the next a difference of steps fits 32 bits.
struct SteppedAngles {
    double unit = 0.0;
    std::vector<std::int32_t> steps;

    friend bool operator==(const SteppedAngles&, const SteppedAngles&) = default;
};

/// Where the beams of a scan point.
using BeamAngles = std::variant<UniformAngles, ExplicitAngles, SteppedAngles>;

[[nodiscard]] std::size_t beam_count(const BeamAngles& angles) noexcept;

/// Direction of beam `index` < beam_count(angles), radians in the sensor frame, not normalised.
[[nodiscard]] double beam_angle(const BeamAngles& angles, std::size_t index) noexcept;

} // namespace scanloom
