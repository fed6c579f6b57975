#pragma once

#include "common/scan/scan.hpp"
#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/ray_models.hpp"

#include <cstddef>
#include <span>

/// How much there is to do, so that a scan can be woven in slices: about the cells and rows of cells that are visited.
namespace scanloom::mapping {

/// Of what is done for each chunk that a scan touched, whatever it did there.
inline constexpr double kWorkPerChunk = 512.0;

/// Of a chunk in which a sweep has a verdict, all layers of lasers together.
inline constexpr double kWorkPerSweptChunk = 2048.0;

/// Of tracing one beam.
[[nodiscard]] double work_of_beam(const Reading& reading, const RayGeometry& geometry) noexcept;

/// Of one cone of a sonar, where each cell costs more than a laser's.
[[nodiscard]] double work_of_cone(double aperture, RangeMm range, const ModelGeometry& geometry) noexcept;

/// How far a reading shows anything; metres, 0 when it shows nothing.
[[nodiscard]] double reached(RangeMm range, const ModelGeometry& geometry) noexcept;

} // namespace scanloom::mapping
