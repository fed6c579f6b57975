#pragma once

#include "common/geometry/pose2.hpp"

#include <span>

namespace scanloom::landmarks {

/// How much a cluster is like a piece of a wall that was seen without a break. Each in [0, 1].
struct Continuity {
    double linearity = 0.0; ///< 1 - minor / major eigenvalue of the points' covariance
    double evenness = 0.0;  ///< 1 / (1 + cv), cv the standard deviation of the gaps divided by their mean
    double fill = 0.0;      ///< how much of the extent is in gaps below 2 eps

    [[nodiscard]] double mean() const noexcept { return (linearity + evenness + fill) / 3.0; }

    friend bool operator==(const Continuity&, const Continuity&) = default;
};

/// Of the points of one cluster, in any order.
///
/// Gaps are between successive points along the major axis, equal points included, which have a gap of 0; the extent
/// is their sum. The standard deviation is that of the gaps themselves (divided by their number). Where no axis is the
/// major one, it is the x axis. Without extent (no point, one, all equal) there is nothing continuous: all are 0. Two
/// points have one gap, which is even.
///
/// Units   metres.
/// Pre     the points pass check_points(); eps > 0.
/// Cost    n log n.
[[nodiscard]] Continuity continuity_of(std::span<const Point2> points, double eps);

} // namespace scanloom::landmarks
