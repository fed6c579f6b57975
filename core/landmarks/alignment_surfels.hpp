#pragma once

#include "core/landmarks/alignment.hpp"

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

/// Computes the surface elements of views from several places, all in one frame, ordered by rows.
///
/// The line of an element is fitted to the points around it: one square to each side, and more where the points were
/// seen from further away. Far away, neighbouring beams meet a wall further apart than the side of a square, and noise
/// in their angles spreads each point across its direction: the points of one square show the beam, not the wall.
/// @param views   points and sensor positions, metres, all in one frame
/// @param around  how far the line extends to each side, as a fraction of the distance it was seen from; 0: one square
///     at any distance
/// Precondition: the points and the sensor positions pass check_points().
/// Cost: O(n log n).
[[nodiscard]] std::vector<Surfel> surfels_of(std::span<const CloudView> views, double around);

/// The parameter `around` of surfels_of() for a single view.
inline constexpr double kAroundOfView = 0.03;

/// Computes the surface elements of a single view.
/// @param view    points and sensor position, metres
/// @param around  how far the lines extend to each side, as a fraction of the distance they were seen from
[[nodiscard]] inline std::vector<Surfel> surfels_of(const CloudView& view, double around = kAroundOfView) {
    return surfels_of({&view, 1}, around);
}

/// Transforms a surface element from frame b to frame a.
/// @param T_a_b     pose of frame b in frame a
/// @param surfel_b  in frame b
[[nodiscard]] Surfel transformed(const Pose2& T_a_b, const Surfel& surfel_b);

/// Returns the positions of surface elements.
[[nodiscard]] std::vector<Point2> positions_of(std::span<const Surfel> surfels);

} // namespace scanloom::landmarks
