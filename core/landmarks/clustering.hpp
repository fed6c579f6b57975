#pragma once

#include "common/error/error.hpp"
#include "core/landmarks/points.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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
/// @param cloud       metres
/// @param min_points  as in dbscan()
/// @return eps, metres, kThinningSide .. kAdaptiveEpsMax
/// Precondition: the cloud passed check_points().
/// Errors: kInvalidField if min_points is out of range; see dbscan().
/// Cost: O(n log n).
/// Source: the sorted k-distances of Ester et al. (KDD 1996), section 4.2. A quantile replaces their valley, because
///     the position of the strongest bend depends on the largest values, which are stray points.
[[nodiscard]] Result<double> adaptive_eps(const DistinctPoints& cloud, std::size_t min_points);

inline constexpr std::int32_t kNoise = -1; ///< cluster of a point that belongs to none

inline constexpr double kEpsMin = 1e-6;            ///< metres
inline constexpr double kEpsMax = 1e6;             ///< metres
inline constexpr std::size_t kMinPointsMax = 1000; ///< of the parameter min_points

/// An assignment of points to clusters.
struct Clustering {
    std::vector<std::int32_t> cluster_of; ///< for each point 0 .. clusters - 1, or kNoise
    std::size_t clusters = 0;             ///< number of clusters

    friend bool operator==(const Clustering&, const Clustering&) = default;
};

/// Finds clusters of dense points of any shape (DBSCAN).
///
/// A core point has at least `min_points` points within `eps` of it, including itself and equal points. A cluster is a
/// maximal set of core points that are connected by steps of at most `eps`, and the border points whose nearest core
/// point is in it (of equally near ones, the one with the lowest index). All other points are noise. Clusters are
/// numbered by their first core point. So the result depends on the points only; in the paper a border point belongs to
/// the cluster that is found first.
/// @param points      metres
/// @param eps         metres; a distance is within eps if dx * dx + dy * dy <= eps * eps in double precision
/// @param min_points  points, at least 1
/// Errors: kInvalidField if eps is outside kEpsMin .. kEpsMax or min_points outside 1 .. kMinPointsMax; those of
///     check_points().
/// Cost: O(n log n), however many points lie within eps of each other; at worst n * min_points more.
/// Source: Ester, Kriegel, Sander, Xu, A Density-Based Algorithm for Discovering Clusters (KDD 1996), definitions 2 to
///     6; the grid: Gunawan, A Faster Algorithm for DBSCAN (TU Eindhoven, 2013).
[[nodiscard]] Result<Clustering> dbscan(std::span<const Point2> points, double eps, std::size_t min_points);

/// Finds clusters in a cloud whose equal points were merged before. Clustering::cluster_of is by the points of the
/// cloud.
/// @param points      metres; each counts as often as it occurs in the cloud
/// @param eps         metres
/// @param min_points  points, at least 1
/// Precondition: the points of the cloud passed check_points().
/// Errors: kInvalidField as the other overload.
[[nodiscard]] Result<Clustering> dbscan(const DistinctPoints& points, double eps, std::size_t min_points);

/// Checks the range of eps.
/// @param eps  metres
/// Errors: kInvalidField if eps is outside kEpsMin .. kEpsMax.
[[nodiscard]] Result<> check_eps(double eps);
/// Checks the range of min_points.
/// @param min_points  points
/// Errors: kInvalidField if min_points is outside 1 .. kMinPointsMax.
[[nodiscard]] Result<> check_min_points(std::size_t min_points);

} // namespace scanloom::landmarks
