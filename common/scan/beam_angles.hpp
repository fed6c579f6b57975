#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace scanloom {

/// Beam i points along first + i * increment. Radians in the sensor frame, counter-clockwise.
struct UniformAngles {
    double first = 0.0;      ///< radians
    double increment = 0.0;  ///< radians; negative if the sensor turns clockwise
    std::uint32_t count = 0; ///< beams

    friend bool operator==(const UniformAngles&, const UniformAngles&) = default;
};

/// One angle per beam, for beams that are not evenly spaced. Radians in the sensor frame.
using ExplicitAngles = std::vector<double>;

/// Beam i points along unit * steps[i], for spinning sensors that measure angles in whole steps. Radians in the sensor
/// frame. The difference between the steps of successive beams fits 32 bits.
struct SteppedAngles {
    double unit = 0.0;               ///< radians of one step
    std::vector<std::int32_t> steps; ///< one per beam

    friend bool operator==(const SteppedAngles&, const SteppedAngles&) = default;
};

/// The directions of the beams of a scan.
using BeamAngles = std::variant<UniformAngles, ExplicitAngles, SteppedAngles>;

/// Returns the number of beams.
[[nodiscard]] std::size_t beam_count(const BeamAngles& angles) noexcept;

/// Returns the direction of a beam, in radians in the sensor frame, not normalised.
/// @param angles  of a scan or a sensor
/// @param index   number of the beam, from 0
/// Precondition: index < beam_count(angles).
[[nodiscard]] double beam_angle(const BeamAngles& angles, std::size_t index) noexcept;

} // namespace scanloom
