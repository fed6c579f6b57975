#pragma once

#include "core/scan_matching/scan_points.hpp"
#include "core/scan_matching/transform2.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::scan_matching {

/// What a robot saw from one place. Refers to the points, which must outlive it.
struct View {
    Transform2 T_map_robot;               ///< in the frame of the map that the view becomes part of
    std::span<const SurfacePoint> points; ///< robot frame
    Point2 laser{0.0, 0.0};               ///< metres, robot frame: where the beams start
};

/// Returns a point of frame b, with its normal, in frame a.
[[nodiscard]] SurfacePoint transform(const Transform2& T_a_b, const SurfacePoint& point) noexcept;

/// A map of points with normals: some views in one frame, with at most one point in each square of kThinning. Finds
/// the nearest point of a surface that faces the same side. Immutable.
/// Points are kept as float: more than 10 km from the origin, rounding exceeds 1 mm. Memory: 100 bytes for each square
/// metre of the rectangle around all points, and 16 bytes a point.
/// Precondition: poses and points are finite, and within 1 km of each other.
/// Threads: any number of readers.
class PointMap {
public:
    static constexpr double kThinning = 0.05; ///< metres
    static constexpr double kCell = 0.2;      ///< metres, side of the squares of the search index

    PointMap() = default;

    /// Joins the views, and copies their points. Where several have a point in one square, the first view's remains.
    /// @param views  the most important one first
    explicit PointMap(std::span<const View> views);

    /// A point of the map near another.
    struct Neighbor {
        const SurfacePoint* point = nullptr; ///< nullptr: none is close enough
        float squared_distance = 0.0F;       ///< square metres
    };

    /// Finds the point of the map that is nearest to a point. Points whose normals are both known and more than 60
    /// degrees apart show different sides, and do not count.
    /// @param point     in the map's frame, with its normal
    /// @param distance  metres: the result is closer than this
    [[nodiscard]] Neighbor nearest(const SurfacePoint& point, float distance) const noexcept;

    /// Returns the points, square by square of the index.
    [[nodiscard]] std::span<const SurfacePoint> points() const noexcept { return points_; }

private:
    float x_ = 0.0F; // of the index's lower left corner
    float y_ = 0.0F;
    std::int32_t width_ = 0; // squares
    std::int32_t height_ = 0;
    std::vector<std::uint32_t> first_; // of each square, its first point; one more at the end
    std::vector<SurfacePoint> points_;
};

} // namespace scanloom::scan_matching
