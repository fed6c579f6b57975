#pragma once

#include "common/geometry/point2.hpp"
#include "core/scan_matching/point_map.hpp"
#include "core/scan_matching/seen_space.hpp"
#include "core/scan_matching/transform2.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::scan_matching {

/// A map in which PlaceSearch finds places: a pyramid of grids, from cells of 10 cm to cells of 3.2 m, that bound how
/// well points fit anywhere in a cell. Immutable.
/// Memory: 5 bytes for each square of 10 cm of the rectangle around all points. Threads: any number of readers.
/// Source: Hess, Kohler, Rapp, Andor, Real-Time Loop Closure in 2D LIDAR SLAM (2016); here also with the normals of
///     surfaces.
class PlaceMap {
public:
    static constexpr double kReach = 15.0; ///< metres: points farther from their origin do not count
    static constexpr int kLevels = 6;      ///< cells of 10 cm times 2^level

    /// What is in a cell: a bit for each direction that a surface faces, kOpen, and kPassed.
    using Bits = std::uint16_t;
    static constexpr Bits kOpen = 0x100;   ///< some of it is not seen free
    static constexpr Bits kPassed = 0x200; ///< some of it is seen free

    /// A grid of square cells.
    struct Grid {
        std::int32_t width = 0;    ///< columns
        std::int32_t height = 0;   ///< rows
        std::vector<Bits> cells{}; ///< by rows

        /// Returns what is in a cell; what is outside is not seen.
        [[nodiscard]] Bits at(std::int32_t column, std::int32_t row) const noexcept {
            const bool is_inside = static_cast<std::uint32_t>(column) < static_cast<std::uint32_t>(width) &&
                                   static_cast<std::uint32_t>(row) < static_cast<std::uint32_t>(height);
            return is_inside ? cells[index_of(column, row)] : kOpen;
        }

        /// Returns the index of a cell of the grid.
        [[nodiscard]] std::size_t index_of(std::int32_t column, std::int32_t row) const noexcept {
            return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
        }
    };

    /// The grids of a level, by whether they merge two or three cells: along x, and twice that along y.
    using Squares = std::array<Grid, 4>;

    /// @param views  of the map; as for SeenSpace
    explicit PlaceMap(std::span<const View> views);

    /// Returns how many points are near a surface that faces the same side, minus those in seen free space.
    /// @param points        in a frame of their own, metres
    /// @param T_map_points  the place
    [[nodiscard]] int score_of(std::span<const SurfacePoint> points, const Transform2& T_map_points) const;

    /// Returns the lower left corner of all grids, metres, in the map's frame.
    [[nodiscard]] Point2 corner() const noexcept { return corner_; }

    /// Returns the grid of 10 cm.
    [[nodiscard]] const Grid& cells() const noexcept { return cells_; }

    /// Returns, for each cell of a level, what is in it or in one or two neighbours on the left and below.
    /// @param level  1 to kLevels - 1
    [[nodiscard]] const Squares& bounds(int level) const { return bounds_[static_cast<std::size_t>(level - 1)]; }

    /// Returns the bits of the directions that are near a direction; all for a point without a normal.
    /// @param point      tells whether there is a normal
    /// @param direction  of the normal, radians
    /// @param tolerance  radians
    [[nodiscard]] static Bits facing(const SurfacePoint& point, double direction, double tolerance) noexcept;

private:
    [[nodiscard]] static Grid merged(const Grid& grid, std::int32_t step, std::int32_t columns, std::int32_t rows);

    Point2 corner_;
    Grid cells_;
    std::vector<Squares> bounds_; // by level, from 1
};

/// Returns the direction of a point's normal, radians; 0 if it has none.
[[nodiscard]] inline double direction_of(const SurfacePoint& point) noexcept {
    return angle_of(static_cast<double>(point.normal_y), static_cast<double>(point.normal_x));
}

} // namespace scanloom::scan_matching
