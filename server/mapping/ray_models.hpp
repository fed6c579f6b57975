#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/ray_model.hpp"
#include "common/scan/reading.hpp"
#include "server/mapping/beam_fan.hpp"
#include "server/mapping/ray_tracing.hpp"
#include "server/mapping/scan_marks.hpp"

#include <cmath>

namespace scanloom::mapping {

/// The properties of a sensor and a map that beam tracing uses. Lengths are in metres.
struct RayGeometry {
    ReadingRules readings;
    RayModel model = RayModel::kBresenham; ///< or kTraversal
    double hit_radius = 0.0;               ///< cells whose centres are within this distance of a hit count as hit
    double cell_size = 0.05;
};

/// A sensor's position and orientation on the grid.
struct SensorOnGrid {
    SensorOnGrid(const Pose2& T_map_sensor, double cell_size) noexcept
        : at{T_map_sensor.x * (1.0 / cell_size), T_map_sensor.y * (1.0 / cell_size)},
          cosine(std::cos(T_map_sensor.yaw)), sine(std::sin(T_map_sensor.yaw)) {}

    /// Rotates a direction from the sensor frame to the map frame.
    [[nodiscard]] Direction to_map(const Direction& d) const noexcept {
        return {cosine * d.x - sine * d.y, sine * d.x + cosine * d.y};
    }

    GridPoint at;
    double cosine;
    double sine;
};

/// Marks the cells that one beam passes and the cells that it hits. A beam without a return passes all cells up to and
/// including the one at range_max.
/// @param marks  receives the cells
/// @param beam  direction in the sensor frame
/// @param reading  the beam's reading
/// @param sensor  the sensor's pose on the grid
/// @param geometry  ray model, hit radius and cell size
/// Source: the cells: ray_tracing.hpp; the radius: section 3 of the design models.
void trace_beam(ScanMarks& marks, const Direction& beam, const Reading& reading, const SensorOnGrid& sensor,
                const RayGeometry& geometry);

} // namespace scanloom::mapping
