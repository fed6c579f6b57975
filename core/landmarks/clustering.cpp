#include "core/landmarks/clustering.hpp"

#include "core/landmarks/point_index.hpp"
#include "core/landmarks/points.hpp"

#include <boost/pending/disjoint_sets.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
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

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// More core points than these are searched with a tree.
constexpr std::size_t kFewPoints = 64;

/// A core point and its squared distance from a place.
struct Near {
    double squared = std::numeric_limits<double>::infinity();
    std::uint32_t index = kNone;

    [[nodiscard]] auto operator<=>(const Near&) const = default;
};

/// The core points, cell by cell.
class CorePoints {
public:
    explicit CorePoints(std::size_t cells) : trees_(cells) { begin_.reserve(cells + 1); }

    /// Starts the next cell. Cells are added in order, the points of a cell in ascending order.
    void begin_cell() { begin_.push_back(indices_.size()); }
    void add(std::uint32_t index, const Point2& point) {
        indices_.push_back(index);
        points_.push_back(point);
    }
    void end_cells() { begin_cell(); }

    [[nodiscard]] std::span<const std::uint32_t> indices(std::size_t cell) const {
        return std::span(indices_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
    }
    [[nodiscard]] std::span<const Point2> points(std::size_t cell) const {
        return std::span(points_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
    }

    /// Returns the nearest core point of a cell; of equally near ones that with the lowest index.
    [[nodiscard]] Near nearest(std::size_t cell, const Point2& place) {
        const auto candidates = points(cell);
        if (candidates.size() > kFewPoints) {
            auto& tree = trees_[cell];
            if (!tree) tree.emplace(candidates);
            const std::size_t found = tree->nearest(place)->index;
            return {squared_norm(candidates[found] - place), indices(cell)[found]};
        }
        Near nearest;
        for (std::size_t n = 0; n < candidates.size(); ++n) {
            nearest = std::min(nearest, Near{squared_norm(candidates[n] - place), indices(cell)[n]});
        }
        return nearest;
    }

private:
    std::vector<std::uint32_t> indices_;
    std::vector<Point2> points_;
    std::vector<std::size_t> begin_;              // for each cell, and the end
    std::vector<std::optional<PointTree>> trees_; // built on first use
};

class Dbscan {
public:
    Dbscan(const DistinctPoints& distinct, double eps, std::size_t min_points)
        : distinct_(distinct), squared_eps_(eps * eps), min_points_(min_points),
          cells_(CellIndex::of_radius(distinct.points, eps)), core_(cell_count()), sets_(cell_count()),
          cell_of_(distinct.points.size()) {}

    [[nodiscard]] Clustering run() {
        for (std::size_t cell = 0; cell < cell_count(); ++cell) find_core(cell);
        core_.end_cells();
        for (std::size_t cell = 0; cell < cell_count(); ++cell) join(cell);
        const auto clusters = number();
        Clustering clustering{std::vector<std::int32_t>(distinct_.of.size()), clusters};
        std::vector<std::int32_t> cluster_of(distinct_.points.size());
        for (std::size_t cell = 0; cell < cell_count(); ++cell) give_points(cell, cluster_of);
        std::ranges::transform(distinct_.of, clustering.cluster_of.begin(), [&](auto n) { return cluster_of[n]; });
        return clustering;
    }

private:
    [[nodiscard]] std::size_t cell_count() const { return cells_.cells().size(); }
    [[nodiscard]] const CellIndex::Cell& cell_at(std::size_t cell) const { return cells_.cells()[cell]; }

    [[nodiscard]] bool near(std::uint32_t a, std::uint32_t b) const {
        return squared_norm(distinct_.points[a] - distinct_.points[b]) <= squared_eps_;
    }

    void find_core(std::size_t cell) {
        const auto points = cells_.points_of(cell_at(cell));
        core_.begin_cell();
        std::size_t together = 0; // number of points, all within eps of each other
        for (const std::uint32_t point : points) together += distinct_.counts[point];
        for (const std::uint32_t point : points) {
            cell_of_[point] = cell;
            if (is_core(cell, point, together)) core_.add(point, distinct_.points[point]);
        }
    }

    /// Returns whether a point is a core point.
    /// @param count  number of points in its cell
    [[nodiscard]] bool is_core(std::size_t cell, std::uint32_t point, std::size_t count) const {
        if (count >= min_points_) return true;
        cells_.around(cell, [&](std::size_t other) {
            for (const std::uint32_t there : cells_.points_of(cell_at(other))) {
                if (near(point, there)) count += distinct_.counts[there];
                if (count >= min_points_) return false;
            }
            return true;
        });
        return count >= min_points_;
    }

    /// Merges a cell with the earlier cells around it whose core points are within eps.
    void join(std::size_t cell) {
        if (core_.points(cell).empty()) return;
        cells_.around(cell, [&](std::size_t other) {
            if (other > cell) return false;
            const bool is_apart = sets_.find_set(cell) != sets_.find_set(other);
            if (!core_.points(other).empty() && is_apart && meet(cell, other)) sets_.union_set(cell, other);
            return true;
        });
    }

    [[nodiscard]] bool meet(std::size_t a, std::size_t b) {
        const auto [few, many] = core_.points(a).size() <= core_.points(b).size() ? std::pair(a, b) : std::pair(b, a);
        return std::ranges::any_of(core_.points(few), [&, cell = many](const Point2& point) {
            return core_.nearest(cell, point).squared <= squared_eps_;
        });
    }

    /// Numbers the clusters by their first core points. Returns the number of clusters.
    std::size_t number() {
        std::vector<std::uint32_t> first(cell_count(), kNone); // for each set, its first core point
        for (std::size_t cell = 0; cell < cell_count(); ++cell) {
            if (core_.indices(cell).empty()) continue;
            std::uint32_t& at = first[sets_.find_set(cell)];
            at = std::min(at, core_.indices(cell).front());
        }
        std::vector<std::uint32_t> firsts;
        std::ranges::copy_if(first, std::back_inserter(firsts), [](auto point) { return point != kNone; });
        std::ranges::sort(firsts);
        cluster_of_set_.assign(cell_count(), kNoise);
        for (std::size_t n = 0; n < firsts.size(); ++n) {
            cluster_of_set_[sets_.find_set(cell_of_[firsts[n]])] = static_cast<std::int32_t>(n);
        }
        return firsts.size();
    }

    void give_points(std::size_t cell, std::vector<std::int32_t>& cluster_of) {
        for (const std::uint32_t point : cells_.points_of(cell_at(cell))) {
            const auto owner = nearest_core(cell, point);
            cluster_of[point] = owner == kNone ? kNoise : cluster_of_set_[sets_.find_set(cell_of_[owner])];
        }
    }

    /// Returns the core point that determines a point's cluster, which is the point itself if it is a core point; kNone
    /// for noise.
    [[nodiscard]] std::uint32_t nearest_core(std::size_t cell, std::uint32_t point) {
        if (std::ranges::binary_search(core_.indices(cell), point)) return point;
        const Point2& place = distinct_.points[point];
        Near nearest = core_.nearest(cell, place);
        cells_.around(cell, [&](std::size_t other) {
            nearest = std::min(nearest, core_.nearest(other, place));
            return true;
        });
        return nearest.squared <= squared_eps_ ? nearest.index : kNone;
    }

    const DistinctPoints& distinct_;
    double squared_eps_;
    std::size_t min_points_;
    CellIndex cells_;
    CorePoints core_;
    boost::disjoint_sets_with_storage<> sets_; // of cells
    std::vector<std::size_t> cell_of_;
    std::vector<std::int32_t> cluster_of_set_;
};

} // namespace

Result<> check_eps(double eps) {
    if (eps >= kEpsMin && eps <= kEpsMax) return {};
    return Error{Errc::kInvalidField, fmt::format("eps is {} m; it must be {:g} .. {:g}", eps, kEpsMin, kEpsMax)};
}

Result<> check_min_points(std::size_t min_points) {
    if (min_points >= 1 && min_points <= kMinPointsMax) return {};
    return Error{Errc::kInvalidField, fmt::format("min_points is {}; it must be 1 .. {}", min_points, kMinPointsMax)};
}

Result<Clustering> dbscan(std::span<const Point2> points, double eps, std::size_t min_points) {
    if (auto valid = check_points(points); !valid) return valid.error();
    return dbscan(distinct_points(points), eps, min_points);
}

Result<Clustering> dbscan(const DistinctPoints& points, double eps, std::size_t min_points) {
    if (auto valid = check_eps(eps); !valid) return valid.error();
    if (auto valid = check_min_points(min_points); !valid) return valid.error();
    return Dbscan(points, eps, min_points).run();
}

} // namespace scanloom::landmarks
