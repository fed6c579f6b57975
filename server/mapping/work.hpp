#pragma once

#include "common/scan/scan.hpp"
#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/ray_models.hpp"

#include <cstddef>
#include <span>

/// Estimates of work, used to integrate a scan in slices. The unit is about one visited cell or row of cells.
namespace scanloom::mapping {

/// Fixed work for each chunk that a scan changes.
inline constexpr double kWorkPerChunk = 512.0;

/// Work for a chunk in which a sweep has a verdict, for all laser layers together.
inline constexpr double kWorkPerSweptChunk = 2048.0;

/// Returns the work of tracing one beam.
[[nodiscard]] double work_of_beam(const Reading& reading, const RayGeometry& geometry) noexcept;

/// Returns the work of one sonar cone, where each cell costs more than with a laser.
/// @param aperture  full width of the cone, radians
[[nodiscard]] double work_of_cone(double aperture, RangeMm range, const ModelGeometry& geometry) noexcept;

/// Returns the distance up to which a reading shows anything, in metres; 0 if it shows nothing.
[[nodiscard]] double reached(RangeMm range, const ModelGeometry& geometry) noexcept;

} // namespace scanloom::mapping
