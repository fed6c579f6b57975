#pragma once

#include "common/geometry/pose2.hpp"

#include <span>

namespace scanloom::landmarks {

/// How similar a cluster is to a piece of a wall that was seen without interruption. Each value is in [0, 1].
struct Continuity {
    double linearity = 0.0; ///< 1 - minor / major eigenvalue of the points' covariance
    double evenness = 0.0;  ///< 1 / (1 + cv), cv the standard deviation of the gaps divided by their mean
    double fill = 0.0;      ///< fraction of the extent that is in gaps below 2 eps

    [[nodiscard]] double mean() const noexcept { return (linearity + evenness + fill) / 3.0; }

    friend bool operator==(const Continuity&, const Continuity&) = default;
};

/// Computes the continuity of the points of one cluster, in any order.
///
/// Gaps are between successive points along the major axis; equal points have a gap of 0. The extent is the sum of the
/// gaps. The standard deviation is that of the gaps themselves (divided by their number). If no axis is the major one,
/// the x axis is used. Without extent (no point, one point, all points equal) all values are 0. Two points have one
/// gap, so their evenness is 1.
/// @param points  metres
/// @param eps     metres
/// Precondition: the points pass check_points(); eps > 0.
/// Cost: O(n log n).
[[nodiscard]] Continuity continuity_of(std::span<const Point2> points, double eps);

} // namespace scanloom::landmarks
