#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/reading.hpp"
#include "common/scan/scan.hpp"
#include "core/grid/cell.hpp"
#include "core/mapping/beam_fan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace scanloom::mapping {

namespace detail {

/// The range of cell centres x_low <= x < x_high in a row, relative to the sensor, in cells.
struct RowSpan {
    double x_low = -HUGE_VAL;
    double x_high = HUGE_VAL;
};

/// The part of a sector in the half-plane above the sensor, between its clockwise edge `right` and `left`. An edge
/// outside the half-plane sets no limit: a sector spans at most a quarter turn and therefore reaches the horizon on
/// that side.
struct UpperSector {
    Direction right;
    Direction left;

    [[nodiscard]] bool right_above() const noexcept { return right.y > 0.0; }
    [[nodiscard]] bool left_above() const noexcept { return left.y > 0.0; }
    [[nodiscard]] bool empty() const noexcept { return !right_above() && !left_above(); }

    /// Returns the height of the highest point of the disc sector with this radius.
    [[nodiscard]] double top(double radius) const noexcept {
        const bool starts_right = !right_above() || right.x >= 0.0;
        const bool ends_left = !left_above() || left.x <= 0.0;
        return starts_right && ends_left ? radius : radius * std::max(right.y, left.y);
    }

    /// Returns the part of the row at height y that the sector covers.
    /// Precondition: !empty() and y > 0.
    [[nodiscard]] RowSpan at(double y) const noexcept {
        RowSpan span;
        if (right_above()) span.x_high = right.x / right.y * y;
        if (left_above()) span.x_low = left.x / left.y * y;
        return span;
    }
};

/// Returns the first column whose centre lies at x or beyond.
/// @param x  position relative to the sensor, in cells
/// @param x0  the sensor's position, in cells
[[nodiscard]] inline std::int32_t column_from(double x, double x0) noexcept {
    return static_cast<std::int32_t>(std::ceil(x + x0 - 0.5));
}

} // namespace detail

/// Calls row(j, dy, i_begin, i_end) for each row of cells, i_begin < i_end, whose centres lie in a sector of a disc.
///
/// Together, the sectors of a fan visit each centre at most once. Cell (i, j) has its centre at (i + 0.5, j + 0.5); dy
/// is the height of the row's centres above the sensor. All lengths are in cells.
/// @param sector  directions in the map frame
/// @param x0  the sensor's x, in cells
/// @param y0  the sensor's y, in cells
/// @param radius  of the disc, in cells; >= 0
/// @param row  receives the rows
/// Cost: the rows that the sector crosses.
template <class Row>
void scan_convert(const Sector& sector, double x0, double y0, double radius, Row&& row) {
    const auto clipped = [&](std::int32_t j, double dy, const detail::RowSpan& span) {
        const double reach = std::sqrt(std::max(0.0, radius * radius - dy * dy));
        if (span.x_low > reach || span.x_high < -reach) return;
        const std::int32_t begin = detail::column_from(std::max(span.x_low, -reach), x0);
        const std::int32_t end = detail::column_from(std::min(span.x_high, reach), x0);
        if (begin < end) row(j, dy, begin, end);
    };

    const detail::UpperSector upper{sector.low, sector.high};
    const auto first_above = static_cast<std::int32_t>(std::floor(y0 - 0.5)) + 1;
    if (!upper.empty()) {
        const auto last = static_cast<std::int32_t>(std::floor(y0 + upper.top(radius) - 0.5));
        for (std::int32_t j = first_above; j <= last; ++j) {
            const double dy = j + 0.5 - y0;
            clipped(j, dy, upper.at(dy));
        }
    }

    const detail::UpperSector lower{{sector.high.x, -sector.high.y}, {sector.low.x, -sector.low.y}}; // mirrored
    const auto first_below = static_cast<std::int32_t>(std::ceil(y0 - 0.5)) - 1;
    if (!lower.empty()) {
        const auto last = static_cast<std::int32_t>(std::ceil(y0 - lower.top(radius) - 0.5));
        for (std::int32_t j = first_below; j >= last; --j) {
            const double dy = j + 0.5 - y0;
            clipped(j, dy, lower.at(-dy));
        }
    }

    if (first_above - first_below < 2) return;
    // A row of centres exactly at the sensor's height lies in the directions 0 and pi.
    const std::int32_t level = first_below + 1;
    const Direction& low = sector.low;
    const Direction& high = sector.high;
    if (high.y > 0.0 && (low.y < 0.0 || (low.y == 0.0 && low.x > 0.0))) clipped(level, 0.0, {0.0, HUGE_VAL});
    if (high.y < 0.0 && (low.y > 0.0 || (low.y == 0.0 && low.x < 0.0))) clipped(level, 0.0, {-HUGE_VAL, 0.0});
}

/// The evidence of a scan for a cell.
enum class Verdict : std::uint8_t { kFree, kOccupied };

/// The properties of a sensor and a map that the model uses. Lengths are in metres.
struct ModelGeometry {
    ReadingRules readings;   ///< range limits of the sensor
    double thickness = 0.1;  ///< alpha; at least one cell is used
    double cell_size = 0.05; ///< side of a cell

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
