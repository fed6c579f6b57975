#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/distinct_points.hpp"

#include <cstddef>

namespace scanloom::landmarks {

/// The side of the squares that adaptive_eps() thins a cloud to, and the least it answers: five standard deviations of
/// a cheap lidar's noise. What is nearer to each other is the same surface.
inline constexpr double kThinningSide = 0.1; // metres

/// The most it answers: things further apart than that are not one thing, however thin a scan is where it is far.
inline constexpr double kAdaptiveEpsMax = 0.5; // metres

/// The eps with which dbscan() finds the things in a room, from how far each point's neighbours are.
///
/// It is the distance that three quarters of the points have at most to their fifth nearest neighbour, in a cloud
/// thinned to one point in each square of kThinningSide: the first. Without thinning it would tell how many turns a
/// standing lidar made, and not how far apart the places are that it sees on a surface: with the turns the fifth
/// neighbour comes nearer and nearer, up to another reading of the same beam, and each beam would be a cluster.
///
/// With min_points above five, as many must be within reach, too: then it is at least the distance that three quarters
/// of the points (of a large cloud: of every n-th) have at most to their min_points-th nearest other one in the whole
/// cloud.
///
/// A point with fewer others counts with the furthest of them. No points, or all in one square: kThinningSide.
///
/// Units   metres.
/// Pre     the cloud passed check_points().
/// Errors  kInvalidField: min_points, see dbscan().
/// Cost    n log n.
/// Source  the sorted k-distances of Ester et al. (KDD 1996), section 4.2. In place of their valley a quantile: where
///         the curve bends most depends on its largest values, which are stray points.
[[nodiscard]] Result<double> adaptive_eps(const DistinctPoints& cloud, std::size_t min_points);

} // namespace scanloom::landmarks
