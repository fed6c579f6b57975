#pragma once

#include "common/geometry/point2.hpp"
#include "core/scan_matching/point_map.hpp"
#include "core/scan_matching/transform2.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::scan_matching {

/// Where points fit a map best.
struct FoundPlace {
    Transform2 T_map_points; ///< within 5 cm and half of a turn of 0.4 degrees of the best pose
    int score = 0;       ///< number of points near a surface that faces the same side, minus those in seen free space
    int rival_score = 0; ///< upper bound of the score of any place more than kApart or kTurnApart away
};

/// What PlaceSearch::find() looks for, and what it may spend.
struct PlaceQuestion {
    int score_min = 1;       ///< places with a lower score are not found; positive
    Point2 center{0.0, 0.0}; ///< metres, in the map's frame: places are searched for around it
    double radius = std::numeric_limits<double>::infinity(); ///< metres: up to this distance
    double rival_share = 0.9; ///< the search ends when no rival has more than this share of the best score, 0 to 1
    std::size_t lookups_max = 8'000'000; ///< of points in the map; these take some tens of milliseconds
};

/// A map in which points are found without an estimate of their place, in every rotation: by branch and bound, from
/// cells of 3.2 m and 12 degrees down to 10 cm and 0.4 degrees. The result is that of trying all of the finest ones.
/// Deterministic: equal inputs give equal bits on every processor.
/// Memory: 5 bytes for each square of 10 cm of the rectangle around all points. Threads: any number of readers.
/// Source: Hess, Kohler, Rapp, Andor, Real-Time Loop Closure in 2D LIDAR SLAM (2016); here with intervals of rotations,
///     and with the normals of surfaces.
class PlaceSearch {
public:
    static constexpr double kReach = 15.0;    ///< metres: points farther from their origin do not count
    static constexpr double kApart = 1.0;     ///< metres between places that are rivals, at least
    static constexpr double kTurnApart = 0.3; ///< radians, or at least this

    /// @param views  of the map; as for SeenSpace
    explicit PlaceSearch(std::span<const View> views);

    /// Finds the best place of some points, with their origin in seen free space.
    /// @param points    in a frame of their own; a few hundred, in any order that does not follow the surfaces
    /// @param question  what counts
    /// @return the best place; nullopt: none is as good as `score_min`, or the lookups did not suffice to tell
    [[nodiscard]] std::optional<FoundPlace> find(std::span<const SurfacePoint> points,
                                                 const PlaceQuestion& question) const;

    /// Returns the score of points at one place; see FoundPlace::score.
    /// @param points        in a frame of their own, metres
    /// @param T_map_points  the place
    [[nodiscard]] int score_of(std::span<const SurfacePoint> points, const Transform2& T_map_points) const;

private:
    static constexpr int kLevels = 6;           // cells of 10 cm times 2^level
    static constexpr std::int32_t kTurns = 960; // of the finest level in a full turn: 15 m * 2 pi / 960 = 0.098 m

    /// What is in a cell: a bit for each direction that a surface faces, kOpen, and kPassed.
    using Bits = std::uint16_t;
    static constexpr Bits kOpen = 0x100;   // some of it is not seen free
    static constexpr Bits kPassed = 0x200; // some of it is seen free

    /// A grid of square cells.
    struct Level {
        std::int32_t width = 0;
        std::int32_t height = 0;
        std::vector<Bits> cells; // by rows

        [[nodiscard]] Bits at(std::int32_t column, std::int32_t row) const noexcept {
            const bool is_inside = static_cast<std::uint32_t>(column) < static_cast<std::uint32_t>(width) &&
                                   static_cast<std::uint32_t>(row) < static_cast<std::uint32_t>(height);
            return is_inside ? cells[index_of(column, row)] : kOpen;
        }

        [[nodiscard]] std::size_t index_of(std::int32_t column, std::int32_t row) const noexcept {
            return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
        }
    };

    class Search;

    /// By whether a square has two or three cells: along x, and twice that along y.
    using Squares = std::array<Level, 4>;

    [[nodiscard]] static Level merged(const Level& level, std::int32_t step, std::int32_t columns, std::int32_t rows);

    Point2 corner_;               // of the grids, metres
    Level cells_;                 // 10 cm
    std::vector<Squares> bounds_; // by level, from 1: each cell with one or two neighbours on the left and below
};

} // namespace scanloom::scan_matching
