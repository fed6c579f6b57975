#pragma once

#include "server/landmarks/cloud_view.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr double kSurfelSpacing = 0.1; ///< metres

/// A surface element: what a cloud shows within a square of kSurfelSpacing, so that a wall counts by its length and not
/// by how often it was measured.
struct Surfel {
    Point2 position{0.0, 0.0}; ///< metres; of a straight one, on the line through the points around it
    Point2 normal{0.0, 0.0};   ///< of that line, a unit vector, either way; zero where the surface is not straight
    [[nodiscard]] bool is_straight() const { return normal.x != 0.0 || normal.y != 0.0; }
};

/// The surface elements of what was seen from some places, all in one frame, by rows.
///
/// A line is told from the points around: a square to each side, and further where they were seen from further away.
/// Far off, neighbouring beams meet a wall further apart than a square is wide, and noise of their angles smears each
/// across its direction: the points of one square show the beam, not the wall.
/// @param around  part of the distance that belongs to a line, to each side; 0: a square at any distance
/// Pre   the points, and where they were seen from, pass check_points().
/// Cost  n log n.
[[nodiscard]] std::vector<Surfel> surfels_of(std::span<const CloudView> views, double around);

inline constexpr double kAroundOfView = 0.03;
[[nodiscard]] inline std::vector<Surfel> surfels_of(const CloudView& view, double around = kAroundOfView) {
    return surfels_of({&view, 1}, around);
}

[[nodiscard]] Surfel transformed(const Pose2& T_a_b, const Surfel& surfel_b);

[[nodiscard]] std::vector<Point2> positions_of(std::span<const Surfel> surfels);

} // namespace scanloom::landmarks
