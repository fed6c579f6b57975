#pragma once

#include "common/geometry/pose2.hpp"
#include "core/landmarks/alignment.hpp"
#include "core/landmarks/alignment_hypotheses.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

/// How similar a cluster is to a piece of a wall that was seen without interruption. Each value is in [0, 1].
struct Continuity {
    double linearity = 0.0; ///< 1 - minor / major eigenvalue of the points' covariance
    double evenness = 0.0;  ///< 1 / (1 + cv), cv the standard deviation of the gaps divided by their mean
    double fill = 0.0;      ///< fraction of the extent that is in gaps below 2 eps

    /// Returns the mean of the three values: the continuity that landmarks report.
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

/// What a view was matched against.
enum class LaidOn {
    kView, ///< a view from one other place
    kMap,  ///< a map seen from many places: mostly not visible from one place, and maybe incomplete
};

/// Performs the acceptance test: returns the best candidate and whether it can be relied on; see Alignment.
///
/// On a map, more of the view must be found, little of it may lie in the map's free space, and its position may be less
/// accurate, because the map is no more accurate itself. If the view is not found as a whole, a distant pose with fewer
/// inliers and hardly more outliers makes the result ambiguous: the map may be incomplete there, and the best pose may
/// only look similar.
///
/// For two views, a pose near the best with hardly fewer inliers does not make the result ambiguous if by far most of
/// the elements in which the two differ support the best, and not only the elements of one thing, which may have
/// moved. All surface elements of both views are compared for this. A distant pose makes the result ambiguous even with
/// fewer inliers if fewer of its elements lie in observed free space.
/// @param candidates  of one view, ranked
/// @param first       what the candidates were matched against
/// Precondition: the candidates are ranked; see rank().
[[nodiscard]] Alignment judge(const std::vector<Candidate>& candidates, LaidOn first);

} // namespace scanloom::landmarks
