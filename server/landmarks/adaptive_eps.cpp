#include "server/landmarks/adaptive_eps.hpp"

#include "server/landmarks/cell_index.hpp"
#include "server/landmarks/clustering.hpp"
#include "server/landmarks/point_tree.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::landmarks {
namespace {

/// A larger quantile merges neighbouring things where a single turn is sparse; a smaller one splits far walls.
constexpr double kQuantile = 0.75;

constexpr std::size_t kNeighbors = 5;
constexpr std::size_t kSamplesMax = 10'000;

/// Returns the least value that at least kQuantile of all values do not exceed, or 0 if there are none.
double quantile(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto rank = static_cast<std::ptrdiff_t>(std::ceil(kQuantile * static_cast<double>(values.size()))) - 1;
    std::ranges::nth_element(values, values.begin() + rank);
    return values[static_cast<std::size_t>(rank)];
}

std::vector<Point2> thinned(const std::vector<Point2>& points) {
    const CellIndex squares = CellIndex::of_side(points, kThinningSide);
    std::vector<Point2> kept;
    kept.reserve(squares.cells().size());
    for (const auto& square : squares.cells()) kept.push_back(points[squares.points_of(square).front()]);
    return kept;
}

/// Returns the quantile of the distances between points on a surface, independent of how often each was seen.
double surface_distance(const std::vector<Point2>& points) {
    const std::vector<Point2> surface = thinned(points);
    const PointTree tree(surface);
    std::vector<double> distances;
    distances.reserve(surface.size());
    for (const Point2& point : surface) distances.push_back(tree.nearest(point, kNeighbors + 1).back().distance);
    return quantile(std::move(distances));
}

/// Returns the distance to the k-th nearest other point; equal points count separately.
double distance_to_nth(const PointTree& tree, const DistinctPoints& cloud, const Point2& point, std::size_t k) {
    std::size_t count = 0;
    double distance = 0.0;
    for (const Neighbor& neighbor : tree.nearest(point, k + 1)) {
        distance = neighbor.distance;
        count += cloud.counts[neighbor.index];
        if (count > k) break;
    }
    return distance;
}

/// Returns the quantile of the distances within which points have `min_points` other points.
double crowd_distance(const DistinctPoints& cloud, std::size_t min_points) {
    const PointTree tree(cloud.points);
    const std::size_t step = cloud.of.size() / kSamplesMax + 1;
    std::vector<double> distances;
    for (std::size_t n = 0; n < cloud.of.size(); n += step) {
        distances.push_back(distance_to_nth(tree, cloud, cloud.points[cloud.of[n]], min_points));
    }
    return quantile(std::move(distances));
}

} // namespace

Result<double> adaptive_eps(const DistinctPoints& cloud, std::size_t min_points) {
    if (auto valid = check_min_points(min_points); !valid) return valid.error();
    double eps = surface_distance(cloud.points);
    if (min_points > kNeighbors) eps = std::max(eps, crowd_distance(cloud, min_points));
    return std::clamp(eps, kThinningSide, kAdaptiveEpsMax);
}

} // namespace scanloom::landmarks
