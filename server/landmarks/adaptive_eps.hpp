#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/distinct_points.hpp"

#include <cstddef>

namespace scanloom::landmarks {

/// The side of the squares to which adaptive_eps() thins a cloud, and its smallest result: five standard deviations of
/// a cheap lidar's noise. Points nearer to each other are on the same surface.
inline constexpr double kThinningSide = 0.1; // metres

/// The largest result of adaptive_eps(): points further apart are not one thing, however sparse a scan is far away.
inline constexpr double kAdaptiveEpsMax = 0.5; // metres

/// Computes the eps with which dbscan() finds the things in a room, from the distances of points to their neighbours.
///
/// The cloud is first thinned to one point, the first, in each square of kThinningSide. Then eps is the distance within
/// which three quarters of the points have their fifth nearest neighbour. Without thinning, eps would measure how many
/// turns a stationary lidar made, and not how far apart the places are that it sees on a surface: with more turns the
/// fifth neighbour comes nearer, until it is another reading of the same beam, and each beam would be a cluster.
///
/// If min_points is above five, that many points must be within reach as well. Then eps is at least the distance within
/// which three quarters of the points (in a large cloud: of every n-th point) have their min_points-th nearest other
/// point in the whole cloud.
///
/// A point with fewer other points counts with the furthest of them. Without points, or with all points in one square,
/// the result is kThinningSide.
/// @param min_points  as in dbscan()
/// @return eps, metres, kThinningSide .. kAdaptiveEpsMax
/// Precondition: the cloud passed check_points().
/// Errors: kInvalidField if min_points is out of range; see dbscan().
/// Cost: O(n log n).
/// Source: the sorted k-distances of Ester et al. (KDD 1996), section 4.2. A quantile replaces their valley, because
///     the position of the strongest bend depends on the largest values, which are stray points.
[[nodiscard]] Result<double> adaptive_eps(const DistinctPoints& cloud, std::size_t min_points);

} // namespace scanloom::landmarks
