#pragma once

#include "sim/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <span>
#include <vector>

namespace scanloom::sim {

/// A part of the plane, divided into equal squares (buckets).
struct BucketFrame {
    double x_min = 0.0; ///< metres
    double y_min = 0.0;
    double side = 1.0; ///< metres, of a bucket
    int columns = 0;
    int rows = 0;

    /// Covers `extent` with about two buckets per item.
    [[nodiscard]] static BucketFrame over(const Box& extent, std::size_t items);

    /// Returns the column or row of any coordinate; coordinates outside the frame give columns and rows outside it.
    [[nodiscard]] int column_of(double x) const noexcept { return static_cast<int>(std::floor((x - x_min) / side)); }
    [[nodiscard]] int row_of(double y) const noexcept { return static_cast<int>(std::floor((y - y_min) / side)); }
    [[nodiscard]] Box box_of(int column, int row) const noexcept {
        return {x_min + column * side, y_min + row * side, x_min + (column + 1) * side, y_min + (row + 1) * side};
    }
    [[nodiscard]] std::size_t index_of(int column, int row) const noexcept {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }
};

/// Index of the shapes that touch each bucket, so that only the shapes near a ray or a point need to be checked. A
/// shape is stored in every bucket that it touches or that is within rounding error. Memory: the shapes, each once for
/// every bucket it is in.
template <class Shape>
class BucketGrid {
public:
    BucketGrid() = default;
    explicit BucketGrid(std::span<const Shape> shapes) {
        if (shapes.empty()) return;
        Box extent = bounds_of(shapes.front());
        for (const Shape& shape : shapes) extent = united(extent, bounds_of(shape));
        frame_ = BucketFrame::over(extent, shapes.size());
        begins_.assign(frame_.index_of(0, frame_.rows) + 1, 0);
        for (const Shape& shape : shapes) for_buckets_of(shape, [&](std::size_t bucket) { ++begins_[bucket + 1]; });
        std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
        shapes_.resize(begins_.back());
        std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
        for (const Shape& shape : shapes) {
            for_buckets_of(shape, [&](std::size_t bucket) { shapes_[next[bucket]++] = shape; });
        }
    }

    [[nodiscard]] const BucketFrame& frame() const noexcept { return frame_; }

    /// Pre: 0 <= column < frame().columns, and likewise for rows.
    [[nodiscard]] std::span<const Shape> in(int column, int row) const noexcept {
        const std::size_t bucket = frame_.index_of(column, row);
        return std::span(shapes_).subspan(begins_[bucket], begins_[bucket + 1] - begins_[bucket]);
    }

    /// Calls visit(shape) for shapes at increasing distances from a point, for some of them more than once, and at
    /// least for all within reach() metres. reach() is called repeatedly and may decrease.
    template <class Reach, class Visit>
    void visit_outwards(const Point2& point, Reach&& reach, Visit&& visit) const {
        if (shapes_.empty()) return;
        const int column = frame_.column_of(point.x);
        const int row = frame_.row_of(point.y);
        const Box home = frame_.box_of(column, row);
        const double to_border =
            std::min({point.x - home.x_min, home.x_max - point.x, point.y - home.y_min, home.y_max - point.y}) -
            slack(); // of the point's bucket
        const int nearest_ring = std::max({0, -column, -row, column - (frame_.columns - 1), row - (frame_.rows - 1)});
        const int farthest_ring =
            std::max(std::max(column, frame_.columns - 1 - column), std::max(row, frame_.rows - 1 - row));
        for (int ring = nearest_ring; ring <= farthest_ring; ++ring) {
            if (ring > 0 && (ring - 1) * frame_.side + to_border > reach()) return;
            for_ring(column, row, ring, [&](int i, int j) {
                for (const Shape& shape : in(i, j)) visit(shape);
            });
        }
    }

private:
    [[nodiscard]] double slack() const noexcept { return 1e-6 * frame_.side; }

    template <class Visit>
    void for_buckets_of(const Shape& shape, Visit&& visit) const {
        const Box bounds = bounds_of(shape);
        // The ends of a segment count as slightly farther out, as in cast_ray().
        const double near = slack() + 1e-8 * std::hypot(bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min);
        const int column_last = std::min(frame_.columns - 1, frame_.column_of(bounds.x_max + near));
        const int row_last = std::min(frame_.rows - 1, frame_.row_of(bounds.y_max + near));
        for (int j = std::max(0, frame_.row_of(bounds.y_min - near)); j <= row_last; ++j) {
            for (int i = std::max(0, frame_.column_of(bounds.x_min - near)); i <= column_last; ++i) {
                if (touch(shape, widened(frame_.box_of(i, j), near))) visit(frame_.index_of(i, j));
            }
        }
    }

    /// Calls visit(i, j) for the buckets of the frame at Chebyshev distance `ring` from the given one.
    template <class Visit>
    void for_ring(int column, int row, int ring, Visit&& visit) const {
        const int first = std::max(0, column - ring);
        const int last = std::min(frame_.columns - 1, column + ring);
        for (int j = std::max(0, row - ring); j <= std::min(frame_.rows - 1, row + ring); ++j) {
            if (std::abs(j - row) == ring) {
                for (int i = first; i <= last; ++i) visit(i, j);
                continue;
            }
            if (column - ring == first) visit(first, j);
            if (column + ring == last && ring > 0) visit(last, j);
        }
    }

    BucketFrame frame_;
    std::vector<std::size_t> begins_; ///< index of the first shape of each bucket, and the end
    std::vector<Shape> shapes_;       ///< bucket by bucket
};

/// The static obstacles of a world, indexed so that few of them need to be checked to find the near ones. All results
/// equal those of checking every obstacle, bit for bit.
///
/// Threads: any thread; the object never changes.
class Obstacles {
public:
    Obstacles() = default;
    Obstacles(std::span<const Segment> outlines, std::span<const Box> solids) : outlines_(outlines), solids_(solids) {}

    /// Returns the distance in metres from `origin` along `yaw_rad` to the first outline. Beyond `range_max` the result
    /// may be infinite. Time: the buckets on the ray and the outlines in them.
    /// Source: Amanatides, Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (1987).
    [[nodiscard]] double cast_ray(const Point2& origin, double yaw_rad, double range_max) const;

    /// Returns the distance in metres to the nearest outline; infinite if there is none.
    [[nodiscard]] double distance(const Point2& point) const;

    /// Returns whether the point is in a solid, borders included.
    [[nodiscard]] bool contain(const Point2& point) const;

    [[nodiscard]] const BucketGrid<Segment>& outlines() const noexcept { return outlines_; }

private:
    BucketGrid<Segment> outlines_;
    BucketGrid<Box> solids_;
};

} // namespace scanloom::sim
