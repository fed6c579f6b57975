#pragma once

#include "common/geometry/pose2.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr double kSurfelSpacing = 0.1; ///< metres

/// A surface element: what a cloud shows within a square of kSurfelSpacing. With surface elements a wall counts by its
/// length, and not by the number of times it was measured.
struct Surfel {
    Point2 position{0.0, 0.0}; ///< metres; if straight, on the line through the points around it
    Point2 normal{0.0, 0.0};   ///< unit vector normal to that line, of either sign; zero if the surface is not straight
    /// Returns whether the element lies on a line.
    [[nodiscard]] bool is_straight() const { return normal.x != 0.0 || normal.y != 0.0; }
};

/// Computes the surface elements of clouds from several places, all in one frame, ordered by rows.
///
/// The line of an element is fitted to the points up to one square to each side: a wall is seen from many places, and
/// where real poses are off by centimetres, a longer piece of it is no line.
/// @param clouds  points, metres, all in one frame
/// Precondition: the points pass check_points().
/// Cost: O(n log n).
[[nodiscard]] std::vector<Surfel> surfels_of(std::span<const std::vector<Point2>> clouds);

/// Transforms a surface element from frame b to frame a.
/// @param T_a_b     pose of frame b in frame a
/// @param surfel_b  in frame b
[[nodiscard]] Surfel transformed(const Pose2& T_a_b, const Surfel& surfel_b);

/// Returns the positions of surface elements.
[[nodiscard]] std::vector<Point2> positions_of(std::span<const Surfel> surfels);

} // namespace scanloom::landmarks
