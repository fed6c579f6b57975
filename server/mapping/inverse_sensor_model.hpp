#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/reading.hpp"
#include "common/scan/scan.hpp"
#include "server/mapping/beam_fan.hpp"
#include "server/mapping/scan_conversion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace scanloom::mapping {

/// The evidence of a scan for a cell.
enum class Verdict : std::uint8_t { kFree, kOccupied };

/// The properties of a sensor and a map that the model uses. Lengths are in metres.
struct ModelGeometry {
    ReadingRules readings;
    double thickness = 0.1; ///< alpha; at least one cell is used
    double cell_size = 0.05;

    /// Returns half the width of the occupied band around a hit, in metres.
    [[nodiscard]] double half_band() const noexcept { return std::max(thickness, cell_size) / 2.0; }
};

/// Evaluates the inverse sensor model of one scan for each cell, without approximation.
///
/// Calls emit(Verdict, j, i_begin, i_end) for the cells i_begin..i_end - 1 of row j. No cell is emitted twice.
///
/// The verdict for a cell depends on the distance r of its centre, on the beam k whose sector contains the centre (the
/// nearest beam, within half the aperture), and on the reading z of that beam:
///   occupied  z < range_max and |r - z| < alpha / 2
///   free      r <= z, r <= range_max, and not occupied
///   (none)    otherwise, and if reading_of() returns no reading for the beam
///
/// @param sectors  the sectors of a BeamFan or a subset of them; the verdicts of different sectors are for different
///                 cells
/// @param ranges  one reading for each beam of the fan
/// @param T_map_sensor  transform from sensor to map coordinates
/// @param geometry  reading limits, obstacle thickness and cell size
/// @param emit  receives the runs of cells
/// Cost: the rows and cells of the area that the scan sees; independent of the map's size.
/// Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.2. A printed variant compares r with z_max in
///         the occupied test, which is a misprint.
template <class Emit>
void inverse_sensor_model(std::span<const Sector> sectors, std::span<const RangeMm> ranges, const Pose2& T_map_sensor,
                          const ModelGeometry& geometry, Emit&& emit) {
    const double cells_per_metre = 1.0 / geometry.cell_size;
    const double x0 = T_map_sensor.x * cells_per_metre;
    const double y0 = T_map_sensor.y * cells_per_metre;
    const double c = std::cos(T_map_sensor.yaw);
    const double s = std::sin(T_map_sensor.yaw);
    const double half_band = geometry.half_band();
    const auto to_map = [&](Direction d) { return Direction{c * d.x - s * d.y, s * d.x + c * d.y}; };

    for (const Sector& sensor_sector : sectors) {
        const auto reading = reading_of(ranges[sensor_sector.beam], geometry.readings);
        if (!reading) continue;
        const Sector sector{sensor_sector.beam, to_map(sensor_sector.low), to_map(sensor_sector.high)};
        if (!reading->is_hit) {
            scan_convert(sector, x0, y0, reading->metres * cells_per_metre,
                         [&](std::int32_t j, double, std::int32_t begin, std::int32_t end) {
                             emit(Verdict::kFree, j, begin, end);
                         });
            continue;
        }
        const double outer = std::min(geometry.readings.range_max, reading->metres + half_band) * cells_per_metre;
        const double inner = std::max(0.0, reading->metres - half_band) * cells_per_metre;
        scan_convert(sector, x0, y0, outer, [&](std::int32_t j, double dy, std::int32_t begin, std::int32_t end) {
            // The row intersects the free disc from -half to +half, if at all.
            const double square = inner * inner - dy * dy;
            std::int32_t free_begin = end;
            std::int32_t free_end = end;
            if (square > 0.0) {
                const double half = std::sqrt(square);
                free_begin = std::clamp(detail::column_from(-half, x0), begin, end);
                free_end = std::clamp(detail::column_from(half, x0), free_begin, end);
            }
            if (begin < free_begin) emit(Verdict::kOccupied, j, begin, free_begin);
            if (free_begin < free_end) emit(Verdict::kFree, j, free_begin, free_end);
            if (free_end < end) emit(Verdict::kOccupied, j, free_end, end);
        });
    }
}

} // namespace scanloom::mapping
