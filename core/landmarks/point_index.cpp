#include "core/landmarks/point_index.hpp"

#include "core/landmarks/points.hpp"

#include <nanoflann.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

namespace scanloom::landmarks {
namespace {

/// Side of a square as a fraction of the radius. 1 / sqrt(2) would do; this leaves a hundredth for rounding.
constexpr double kSide = 0.7;

struct Place {
    std::int64_t j;
    std::int64_t i;
    std::uint32_t index;

    [[nodiscard]] bool operator<(const Place& other) const {
        return std::tie(j, i, index) < std::tie(other.j, other.i, other.index);
    }
};

} // namespace

CellIndex CellIndex::of_radius(std::span<const Point2> points, double radius) { return {points, kSide * radius}; }

CellIndex::CellIndex(std::span<const Point2> points, double side) : order_(points.size()) {
    const double per_metre = 1.0 / side;
    const auto cell_of = [&](double metres) { return static_cast<std::int64_t>(std::floor(metres * per_metre)); };
    std::vector<Place> places(points.size());
    for (std::uint32_t n = 0; n < places.size(); ++n) places[n] = {cell_of(points[n].y), cell_of(points[n].x), n};
    std::sort(places.begin(), places.end());
    for (std::uint32_t n = 0; n < places.size(); ++n) {
        const Place& place = places[n];
        order_[n] = place.index;
        if (n == 0 || place.j != cells_.back().j || place.i != cells_.back().i) {
            cells_.push_back({place.j, place.i, n, n});
        }
        cells_.back().end = n + 1;
    }
}

std::size_t CellIndex::first_from(std::int64_t j, std::int64_t i) const {
    const auto comes_before = [](const Cell& cell, const std::pair<std::int64_t, std::int64_t>& at) {
        return std::tie(cell.j, cell.i) < std::tie(at.first, at.second);
    };
    const auto found = std::lower_bound(cells_.begin(), cells_.end(), std::pair(j, i), comes_before);
    return static_cast<std::size_t>(found - cells_.begin());
}

namespace {

constexpr std::size_t kLeafPoints = 16;

/// Adapter through which nanoflann reads the points.
struct Cloud {
    std::vector<Point2> points;

    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] double kdtree_get_pt(std::uint32_t index, std::size_t axis) const {
        return axis == 0 ? points[index].x : points[index].y;
    }
    template <class Bounds>
    bool kdtree_get_bbox(Bounds&) const {
        return false;
    }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 2, std::uint32_t>;

/// A point that was found, with its squared distance.
struct Found {
    double squared;
    std::uint32_t index;

    [[nodiscard]] auto operator<=>(const Found&) const = default;
};

/// Returns a slightly larger bound. nanoflann excludes points at the bound, and rounds its bounds of branches; with a
/// larger bound, all points exactly at the original bound are examined.
double beyond(double squared) { return squared * (1.0 + 1e-9) + std::numeric_limits<double>::min(); }

/// Collects the nearest points for nanoflann. `found` is a heap with the furthest point on top.
class Nearest {
public:
    explicit Nearest(std::size_t count) : count_(count) { found_.reserve(count); }

    [[nodiscard]] bool full() const { return found_.size() == count_; }
    [[nodiscard]] double worstDist() const {
        return full() ? beyond(found_.front().squared) : std::numeric_limits<double>::infinity();
    }
    bool addPoint(double squared, std::uint32_t index) {
        const Found found{squared, index};
        if (full()) {
            if (!(found < found_.front())) return true;
            std::ranges::pop_heap(found_);
            found_.back() = found;
        } else {
            found_.push_back(found);
        }
        std::ranges::push_heap(found_);
        return true;
    }

    [[nodiscard]] std::vector<Found>& found() { return found_; }

private:
    std::size_t count_;
    std::vector<Found> found_;
};

/// Collects only the nearest point, without a heap.
class First {
public:
    /// @param radius  of the search: points farther away may be left out
    explicit First(double radius = std::numeric_limits<double>::infinity()) : found_{beyond(radius * radius), kNone} {}

    [[nodiscard]] bool full() const { return true; }
    [[nodiscard]] double worstDist() const { return beyond(found_.squared); }
    bool addPoint(double squared, std::uint32_t index) {
        found_ = std::min(found_, Found{squared, index});
        return true;
    }

    [[nodiscard]] bool has_found() const { return found_.index != kNone; }
    [[nodiscard]] const Found& found() const { return found_; }

private:
    static constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    Found found_;
};

/// Collects all points within a radius.
class Within {
public:
    explicit Within(double radius) : squared_(radius * radius) {}

    [[nodiscard]] bool full() const { return true; }
    [[nodiscard]] double worstDist() const { return beyond(squared_); }
    bool addPoint(double squared, std::uint32_t index) {
        if (squared <= squared_) found_.push_back({squared, index});
        return true;
    }

    [[nodiscard]] std::vector<Found>& found() { return found_; }

private:
    double squared_;
    std::vector<Found> found_;
};

Neighbor neighbor(const Found& found) { return {found.index, std::sqrt(found.squared)}; }

std::vector<Neighbor> in_order(std::vector<Found>& found) {
    std::ranges::sort(found);
    std::vector<Neighbor> neighbors(found.size());
    std::ranges::transform(found, neighbors.begin(), neighbor);
    return neighbors;
}

} // namespace

struct PointTree::Tree {
    explicit Tree(std::span<const Point2> points)
        : cloud{{points.begin(), points.end()}},
          index(2, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafPoints)) {}

    template <class Results>
    void search(Results& results, const Point2& place) const {
        assert(is_finite(place));
        const std::array coordinates = {place.x, place.y};
        index.findNeighbors(results, coordinates.data(), nanoflann::SearchParams());
    }

    Cloud cloud;
    Index index;
};

PointTree::PointTree(std::span<const Point2> points) {
    assert(points.size() <= kCloudPointsMax);
    assert(std::ranges::all_of(points, [](const Point2& point) { return is_finite(point); }));
    tree_ = std::make_unique<const Tree>(points);
}

PointTree::PointTree(PointTree&& other) noexcept = default;
PointTree& PointTree::operator=(PointTree&& other) noexcept = default;
PointTree::~PointTree() = default;

std::size_t PointTree::size() const noexcept { return tree_->cloud.points.size(); }

std::optional<Neighbor> PointTree::nearest(const Point2& place) const {
    if (size() == 0) return std::nullopt;
    First first;
    tree_->search(first, place);
    return neighbor(first.found());
}

std::optional<Neighbor> PointTree::nearest_within(const Point2& place, double radius) const {
    if (size() == 0) return std::nullopt;
    First first(radius);
    tree_->search(first, place);
    if (!first.has_found()) return std::nullopt;
    const Neighbor found = neighbor(first.found());
    return found.distance <= radius ? std::optional(found) : std::nullopt;
}

std::vector<Neighbor> PointTree::nearest(const Point2& place, std::size_t count) const {
    count = std::min(count, size());
    if (count == 0) return {};
    Nearest nearest(count);
    tree_->search(nearest, place);
    return in_order(nearest.found());
}

std::vector<Neighbor> PointTree::within(const Point2& place, double radius) const {
    assert(radius >= 0.0);
    Within within(radius);
    tree_->search(within, place);
    return in_order(within.found());
}

} // namespace scanloom::landmarks
