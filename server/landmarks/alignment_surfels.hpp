#pragma once

#include "common/geometry/pose2.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr double kSurfelSpacing = 0.1; ///< metres

/// A surface element: what a cloud shows within a square of kSurfelSpacing, so that a wall counts by its length and not
/// by how often it was measured.
struct Surfel {
    Point2 position{0.0, 0.0}; ///< metres; of a straight one, on the line through the points around it
    Point2 normal{0.0, 0.0};   ///< of that line, a unit vector, either way; zero where the surface is not straight
    [[nodiscard]] bool is_straight() const { return normal.x() != 0.0 || normal.y() != 0.0; }
};

/// The surface elements of a cloud, by rows.
/// Pre   the points pass check_points().
/// Cost  n log n.
[[nodiscard]] std::vector<Surfel> surfels_of(std::span<const Point2> points);

[[nodiscard]] Surfel transformed(const Pose2& T_a_b, const Surfel& surfel_b);

[[nodiscard]] std::vector<Point2> positions_of(std::span<const Surfel> surfels);

} // namespace scanloom::landmarks
