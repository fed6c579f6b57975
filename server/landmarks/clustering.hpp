#pragma once

#include "common/error/error.hpp"
#include "server/landmarks/distinct_points.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr std::int32_t kNoise = -1;

inline constexpr double kEpsMin = 1e-6; ///< metres
inline constexpr double kEpsMax = 1e6;  ///< metres
inline constexpr std::size_t kMinPointsMax = 1000;

/// Which points belong together.
struct Clustering {
    std::vector<std::int32_t> cluster_of; ///< for each point 0 .. clusters - 1, or kNoise
    std::size_t clusters = 0;

    friend bool operator==(const Clustering&, const Clustering&) = default;
};

/// Clusters of dense points, whatever their shape (DBSCAN).
///
/// A core point has at least `min_points` points within `eps` of it, itself and its equals among them. A cluster is a
/// largest set of core points that are joined by steps of at most `eps`, and the border points that have their nearest
/// core point in it (of equally near ones: the one with the lowest index). All others are noise. Clusters are numbered
/// by their first core point. So the result depends on nothing but the points: the paper gives a border point to
/// whichever cluster is found first.
///
/// Units   metres. A distance is within eps when dx * dx + dy * dy <= eps * eps in double precision.
/// Errors  kInvalidField: eps outside kEpsMin .. kEpsMax, min_points outside 1 .. kMinPointsMax; those of
///         check_points().
/// Cost    n log n, however many points lie within eps of each other; at worst n * min_points more.
/// Source  Ester, Kriegel, Sander, Xu, A Density-Based Algorithm for Discovering Clusters (KDD 1996), definitions 2
///         to 6; the grid: Gunawan, A Faster Algorithm for DBSCAN (TU Eindhoven, 2013).
[[nodiscard]] Result<Clustering> dbscan(std::span<const Point2> points, double eps, std::size_t min_points);

/// The same of points that were put together before; cluster_of is by the points of the cloud.
/// Pre  those of the cloud passed check_points().
[[nodiscard]] Result<Clustering> dbscan(const DistinctPoints& points, double eps, std::size_t min_points);

/// Errors  kInvalidField, see dbscan().
[[nodiscard]] Result<> check_eps(double eps);
[[nodiscard]] Result<> check_min_points(std::size_t min_points);

} // namespace scanloom::landmarks
