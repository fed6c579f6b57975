#pragma once

#include "common/geometry/pose2.hpp"
#include "common/scan/reading.hpp"
#include "common/scan/session_options.hpp"
#include "core/grid/cell.hpp"
#include "core/grid/chunk.hpp"
#include "core/mapping/beam_fan.hpp"
#include "core/mapping/laser_chunk.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>

namespace scanloom::mapping {

/// A point in cell units. Cell (i, j) is the square from (i, j) to (i + 1, j + 1).
struct GridPoint {
    double x = 0.0; ///< cells
    double y = 0.0; ///< cells
};

/// Returns the cell that contains a point.
/// @param point  in cells; within the int32 range
[[nodiscard]] inline grid::Cell cell_at(GridPoint point) noexcept {
    return {static_cast<std::int32_t>(std::floor(point.x)), static_cast<std::int32_t>(std::floor(point.y))};
}

/// Calls visit(Cell) for the cells of the straight line between two cells, in order, both ends included.
///
/// Each step along the longer axis visits one cell: the one nearest to the line between the two centres. Of two cells
/// at the same distance, it visits the one further along the shorter axis, so that a line has the same shape for every
/// sign of its direction.
/// @param from   first cell
/// @param to     last cell
/// @param visit  receives each cell
/// Source: Bresenham, Algorithm for Computer Control of a Digital Plotter (1965), with its rounding made explicit.
template <class Visit>
void bresenham(grid::Cell from, grid::Cell to, Visit&& visit) {
    const std::int64_t di = std::int64_t{to.i} - from.i;
    const std::int64_t dj = std::int64_t{to.j} - from.j;
    const std::int64_t along_i = std::abs(di);
    const std::int64_t along_j = std::abs(dj);
    const std::int32_t step_i = di < 0 ? -1 : 1;
    const std::int32_t step_j = dj < 0 ? -1 : 1;
    const bool is_flat = along_i >= along_j;
    const std::int64_t longer = is_flat ? along_i : along_j;
    const std::int64_t shorter = is_flat ? along_j : along_i;

    std::int64_t doubled = longer; // 2 * longer * (offset on the shorter axis + 1/2), minus the steps taken
    grid::Cell cell = from;
    visit(cell);
    for (std::int64_t n = 0; n < longer; ++n) {
        doubled += 2 * shorter;
        const bool aside = doubled >= 2 * longer;
        if (aside) doubled -= 2 * longer;
        if (is_flat || aside) cell.i += step_i;
        if (!is_flat || aside) cell.j += step_j;
        visit(cell);
    }
}

/// Calls visit(Cell) for every cell that a segment crosses, in order, from the cell of `from` to the cell of `to`.
/// Where the segment passes exactly through a corner, it visits the adjacent cell along x.
/// @param from   start of the segment, in cells
/// @param to     end of the segment, in cells
/// @param visit  receives each cell
/// Cost: proportional to the cells visited. Each border is computed from the segment's ends, so that rounding errors do
///       not accumulate.
/// Source: Amanatides, Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (1987).
template <class Visit>
void traverse(GridPoint from, GridPoint to, Visit&& visit) {
    grid::Cell cell = cell_at(from);
    const grid::Cell last = cell_at(to);
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const std::int32_t step_i = last.i < cell.i ? -1 : 1;
    const std::int32_t step_j = last.j < cell.j ? -1 : 1;
    // Position on the segment, 0..1, of the next border; infinite once the last column or row is reached.
    const auto to_column = [&] {
        return cell.i == last.i ? HUGE_VAL : ((step_i > 0 ? cell.i + 1.0 : static_cast<double>(cell.i)) - from.x) / dx;
    };
    const auto to_row = [&] {
        return cell.j == last.j ? HUGE_VAL : ((step_j > 0 ? cell.j + 1.0 : static_cast<double>(cell.j)) - from.y) / dy;
    };
    visit(cell);
    double t_column = to_column();
    double t_row = to_row();
    while (cell != last) {
        if (t_column <= t_row) {
            cell.i += step_i;
            t_column = to_column();
        } else {
            cell.j += step_j;
            t_row = to_row();
        }
        visit(cell);
    }
}

/// The cells of one chunk that rays passed or hit.
struct ChunkMarks {
    grid::BitPlane passed{}; ///< by a ray, before its hit
    grid::BitPlane hit{};    ///< where a ray ended at an obstacle
};

/// The cells that the rays of a scan pass and hit. A cell counts once, however many rays cross it, and a hit takes
/// precedence over a pass.
/// Memory: two bits per cell of the chunks that rays touch.
class ScanMarks {
public:
    /// Marks a cell that a ray passes.
    void pass(grid::Cell cell) { mark(cell, &ChunkMarks::passed); }
    /// Marks a cell in which a ray hits something.
    void hit(grid::Cell cell) { mark(cell, &ChunkMarks::hit); }

    /// Returns the marks of all chunks that have any.
    [[nodiscard]] const std::map<grid::ChunkKey, ChunkMarks>& chunks() const noexcept { return chunks_; }

    /// Removes and returns the marks of the first chunk.
    /// Precondition: chunks() is not empty.
    [[nodiscard]] auto take_first() {
        current_ = nullptr;
        return chunks_.extract(chunks_.begin());
    }

private:
    void mark(grid::Cell cell, grid::BitPlane ChunkMarks::*kind) {
        const grid::ChunkKey key = grid::chunk_of(cell);
        if (current_ == nullptr || key != current_key_) { // neighbours on a ray mostly share a chunk
            current_ = &chunks_[key];
            current_key_ = key;
        }
        const auto row = static_cast<std::size_t>(cell.j & (grid::kChunkSide - 1));
        (current_->*kind)[row] |= std::uint64_t{1} << (cell.i & (grid::kChunkSide - 1));
    }

    std::map<grid::ChunkKey, ChunkMarks> chunks_;
    grid::ChunkKey current_key_;
    ChunkMarks* current_ = nullptr;
};

/// Returns the verdicts of a chunk's marks; a hit takes precedence over a pass.
/// @param marks  of one chunk
[[nodiscard]] inline ChunkVerdicts verdicts_of(const ChunkMarks& marks) noexcept {
    ChunkVerdicts verdicts{.occupied = marks.hit};
    for (std::size_t j = 0; j < marks.passed.size(); ++j) {
        verdicts.free[j] = marks.passed[j] & ~marks.hit[j];
        verdicts.free_rows |= std::uint64_t{verdicts.free[j] != 0} << j;
        verdicts.occupied_rows |= std::uint64_t{marks.hit[j] != 0} << j;
    }
    return verdicts;
}

/// The properties of a sensor and a map that beam tracing uses. Lengths are in metres.
struct RayGeometry {
    ReadingRules readings;                 ///< range limits of the sensor
    RayModel model = RayModel::kBresenham; ///< or kTraversal
    double hit_radius = 0.0;               ///< cells whose centres are within this distance of a hit count as hit
    double cell_size = 0.05;               ///< side of a cell
};

/// A sensor's position and orientation on the grid.
struct SensorOnGrid {
    /// Converts a pose to the grid.
    /// @param T_map_sensor  metres, radians
    /// @param cell_size     metres
    SensorOnGrid(const Pose2& T_map_sensor, double cell_size) noexcept
        : at{T_map_sensor.x * (1.0 / cell_size), T_map_sensor.y * (1.0 / cell_size)},
          cosine(std::cos(T_map_sensor.yaw)), sine(std::sin(T_map_sensor.yaw)) {}

    /// Rotates a direction from the sensor frame to the map frame.
    /// @param d  in the sensor frame
    [[nodiscard]] Direction to_map(const Direction& d) const noexcept {
        return {cosine * d.x - sine * d.y, sine * d.x + cosine * d.y};
    }

    GridPoint at;  ///< position, in cells
    double cosine; ///< of its yaw in the map frame
    double sine;   ///< of its yaw in the map frame
};

/// Marks the cells that one beam passes and the cells that it hits. A beam without a return passes all cells up to and
/// including the one at range_max.
/// @param marks  receives the cells
/// @param beam  direction in the sensor frame
/// @param reading  the beam's reading
/// @param sensor  the sensor's pose on the grid
/// @param geometry  ray model, hit radius and cell size
/// Source: Bresenham (1965); Amanatides, Woo (1987): see the functions above.
void trace_beam(ScanMarks& marks, const Direction& beam, const Reading& reading, const SensorOnGrid& sensor,
                const RayGeometry& geometry);

} // namespace scanloom::mapping
